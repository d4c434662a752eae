"""Checks topic and service names."""

from ._names import topic_problem
from .exceptions import InvalidServiceNameException, InvalidTopicNameException


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Raise InvalidTopicNameException, or that for services, for a name that is not legal."""
    problem = topic_problem(name)
    if problem is not None:
        kind = InvalidServiceNameException if is_service else InvalidTopicNameException
        raise kind(name, *problem)
    return True
