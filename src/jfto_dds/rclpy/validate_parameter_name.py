"""Checks parameter names."""

from .exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> bool:
    """Raise InvalidParameterException for an empty name; anything else is legal."""
    if not name:
        raise InvalidParameterException(name)
    return True
