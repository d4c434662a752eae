"""Checks node names."""

from ._names import node_name_problem
from .exceptions import InvalidNodeNameException


def validate_node_name(node_name: str) -> bool:
    """Raise InvalidNodeNameException for a name that is not legal."""
    problem = node_name_problem(node_name)
    if problem is not None:
        raise InvalidNodeNameException(node_name, *problem)
    return True
