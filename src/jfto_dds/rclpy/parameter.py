"""Parameters and their types."""

from __future__ import annotations

import array
import enum
from typing import Any

import yaml
from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterType, ParameterValue

PARAMETER_SEPARATOR_STRING = "."
AllowableParameterValue = Any


class Parameter:
    """A named value of one of the parameter types."""

    class Type(enum.IntEnum):
        """Parameter types, numbered as in rcl_interfaces."""

        NOT_SET = 0
        BOOL = 1
        INTEGER = 2
        DOUBLE = 3
        STRING = 4
        BYTE_ARRAY = 5
        BOOL_ARRAY = 6
        INTEGER_ARRAY = 7
        DOUBLE_ARRAY = 8
        STRING_ARRAY = 9

        def __str__(self) -> str:
            return f"Type.{self.name}"

        @classmethod
        def from_parameter_value(cls, parameter_value: Any) -> Parameter.Type:
            """Find the type of a Python value; an empty list is a BYTE_ARRAY.

            Raises
            ------
            TypeError
                No parameter can hold the value.
            """
            simple = {type(None): cls.NOT_SET, bool: cls.BOOL, str: cls.STRING}
            if type(parameter_value) in simple:
                return simple[type(parameter_value)]
            for kind, found in ((bool, cls.BOOL), (int, cls.INTEGER), (float, cls.DOUBLE)):
                if isinstance(parameter_value, kind):
                    return found
            if isinstance(parameter_value, str):
                return cls.STRING
            if not isinstance(parameter_value, (list, tuple, array.array)):
                msg = f"The given value is not one of the allowed types '{parameter_value}'."
                raise TypeError(msg)
            for element, found in (
                (bytes, cls.BYTE_ARRAY),
                (bool, cls.BOOL_ARRAY),
                (int, cls.INTEGER_ARRAY),
                (float, cls.DOUBLE_ARRAY),
                (str, cls.STRING_ARRAY),
            ):
                if all(isinstance(value, element) for value in parameter_value):
                    return found
            msg = f"The given value is not a list of one of the allowed types '{parameter_value}'."
            raise TypeError(msg)

        def check(self, parameter_value: Any) -> bool:
            """Whether a Python value is of this type."""
            element = _ELEMENT_TYPES.get(self.name)
            if element is not None:
                return isinstance(parameter_value, (list, tuple, array.array)) and all(
                    isinstance(value, element) for value in parameter_value
                )
            return isinstance(parameter_value, _SCALAR_TYPES[self.name])

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> Parameter:
        """Convert from ``rcl_interfaces/Parameter``; raises ValueError for an unknown type."""
        kind = Parameter.Type(value=param_msg.value.type)
        value = None if kind is Parameter.Type.NOT_SET else _value_of(param_msg.value, kind)
        return cls(param_msg.name, kind, value)

    def __init__(self, name: str, type_: Any = None, value: Any = None) -> None:
        if type_ is None:
            type_ = Parameter.Type.from_parameter_value(value)
        if not isinstance(type_, Parameter.Type):
            msg = f"type must be an instance of '{Parameter.Type!r}'"
            raise TypeError(msg)
        if not type_.check(value):
            msg = f"Type '{type_}' and value '{value}' do not agree"
            raise ValueError(msg)
        self._type_ = type_
        self._name = name
        self._value = value

    @property
    def name(self) -> str:
        """The name."""
        return self._name

    @property
    def type_(self) -> Parameter.Type:
        """The type."""
        return self._type_

    @property
    def value(self) -> Any:
        """The value."""
        return self._value

    def get_parameter_value(self) -> Any:
        """Convert to ``rcl_interfaces/ParameterValue``."""
        value = ParameterValue(type=self._type_.value)
        if self._type_ is not Parameter.Type.NOT_SET:
            setattr(value, f"{self._type_.name.lower()}_value", self._value)
        return value

    def to_parameter_msg(self) -> Any:
        """Convert to ``rcl_interfaces/Parameter``."""
        return ParameterMsg(name=self._name, value=self.get_parameter_value())


_SCALAR_TYPES: dict[str, Any] = {
    "NOT_SET": type(None),
    "BOOL": bool,
    "INTEGER": int,
    "DOUBLE": float,
    "STRING": str,
}
_ELEMENT_TYPES: dict[str, type] = {
    "BYTE_ARRAY": bytes,
    "BOOL_ARRAY": bool,
    "INTEGER_ARRAY": int,
    "DOUBLE_ARRAY": float,
    "STRING_ARRAY": str,
}


def _value_of(message: Any, kind: Parameter.Type) -> Any:
    return getattr(message, f"{kind.name.lower()}_value")


def parameter_value_to_python(parameter_value: Any) -> Any:
    """Convert ``rcl_interfaces/ParameterValue`` to plain Python; raises RuntimeError."""
    try:
        kind = Parameter.Type(parameter_value.type)
    except ValueError:
        msg = f"unexpected parameter type {parameter_value.type}"
        raise RuntimeError(msg) from None
    if kind is Parameter.Type.NOT_SET:
        return None
    value = _value_of(parameter_value, kind)
    return list(value) if kind.name.endswith("ARRAY") else value


def get_parameter_value(string_value: str) -> Any:
    """Read a value as the command line tools do, with PyYAML's rules."""
    try:
        parsed = yaml.safe_load(string_value)
    except yaml.YAMLError:
        parsed = string_value
    value = ParameterValue()
    for kind in ("BOOL", "INTEGER", "DOUBLE"):
        if type(parsed) is _SCALAR_TYPES[kind]:
            value.type = getattr(ParameterType, f"PARAMETER_{kind}")
            setattr(value, f"{kind.lower()}_value", parsed)
            return value
    if isinstance(parsed, list):
        for kind in ("BOOL_ARRAY", "INTEGER_ARRAY", "DOUBLE_ARRAY", "STRING_ARRAY"):
            if all(isinstance(item, _ELEMENT_TYPES[kind]) for item in parsed):
                value.type = getattr(ParameterType, f"PARAMETER_{kind}")
                setattr(value, f"{kind.lower()}_value", parsed)
                return value
    value.type = ParameterType.PARAMETER_STRING
    value.string_value = parsed if isinstance(parsed, str) and parsed else string_value
    return value


def parameter_dict_from_yaml_file(*_args: Any, **_kwargs: Any) -> dict[str, Any]:
    """Read a parameter file for a client, which is not supported."""
    msg = "jfto_dds does not support parameter_dict_from_yaml_file: use --params-file"
    raise NotImplementedError(msg)
