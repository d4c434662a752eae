"""Checks absolute namespaces."""

from ._names import namespace_problem
from .exceptions import InvalidNamespaceException


def validate_namespace(namespace: str) -> bool:
    """Raise InvalidNamespaceException for a name that is not legal."""
    problem = namespace_problem(namespace)
    if problem is not None:
        raise InvalidNamespaceException(namespace, *problem)
    return True
