"""Makes topic and service names absolute."""

from . import _remapping
from ._names import node_name_problem, topic_problem, unknown_substitution
from .exceptions import InvalidNamespaceException, InvalidNodeNameException
from .validate_namespace import validate_namespace

__all__ = ["InvalidNamespaceException", "InvalidNodeNameException", "expand_topic_name"]


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Expand ``~``, ``{node}`` and relative names; raises ValueError where it cannot."""
    problem = topic_problem(topic_name)
    if problem is not None:
        msg = f"topic name '{topic_name}' is invalid: {problem.text}"
        raise ValueError(msg)
    wrong_node = node_name_problem(node_name)
    if wrong_node is not None:
        raise InvalidNodeNameException(node_name, *wrong_node)
    validate_namespace(node_namespace)
    unknown = unknown_substitution(topic_name)
    if unknown is not None:
        msg = f"topic name '{topic_name}' is invalid: unknown substitution: {unknown}"
        raise ValueError(msg)
    return _remapping.expand(topic_name, node_name, node_namespace)
