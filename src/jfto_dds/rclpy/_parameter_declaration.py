"""Declaring the parameters of a node."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor

from .exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
)
from .parameter import Parameter
from .validate_parameter_name import validate_parameter_name


class ParameterDeclaration:
    """The declaring part of :class:`NodeParameters`."""

    _parameters: dict[str, Parameter]
    _parameter_overrides: dict[str, Parameter]
    _set_common: Callable[..., Any]

    def declare_parameter(
        self,
        name: str,
        value: Any = None,
        descriptor: Any = None,
        ignore_override: bool = False,
    ) -> Parameter:
        """Declare a parameter with a default value or a type, and perhaps a descriptor.

        Returns the parameter with the value that is in force: an override if there is one.

        Raises
        ------
        ParameterAlreadyDeclaredException, InvalidParameterException,
        InvalidParameterTypeException, InvalidParameterValueException
            What is wrong with it.
        """
        entry: tuple = (name,)
        if value is not None or descriptor is not None:
            entry = (name, value, ParameterDescriptor() if descriptor is None else descriptor)
        return self.declare_parameters("", [entry], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[Any], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare several parameters, ``(name[, value or type[, descriptor]])`` each."""
        declared: list[Parameter] = []
        descriptors: dict[str, Any] = {}
        for index, entry in enumerate(parameters):
            parameter, descriptor = self._read_declaration(namespace, index, entry, ignore_override)
            declared.append(parameter)
            descriptors[parameter.name] = descriptor
        known = [parameter.name for parameter in declared if parameter.name in self._parameters]
        if known:
            raise ParameterAlreadyDeclaredException(known)
        for parameter in declared:
            result = self._set_common([parameter], descriptors, allow_not_set=True)
            if not result.successful:
                if result.reason.startswith("Wrong parameter type"):
                    expected = Parameter.Type(descriptors[parameter.name].type).name
                    raise InvalidParameterTypeException(parameter, expected)
                raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)
        return [self._parameters[parameter.name] for parameter in declared]

    def _read_declaration(
        self, namespace: str, index: int, entry: Any, ignore_override: bool
    ) -> tuple[Parameter, Any]:
        if not 1 <= len(entry) <= 3:
            msg = (
                f"Invalid parameter tuple length at index {index} in parameters list: "
                f"{entry}; expecting length between 1 and 3"
            )
            raise TypeError(msg)
        name = entry[0]
        if not isinstance(name, str):
            msg = f"First element {name} at index {index} in parameters list is not a str."
            raise TypeError(msg)
        if namespace:
            name = f"{namespace}.{name}"
        validate_parameter_name(name)
        value = entry[1] if len(entry) > 1 else None
        descriptor = entry[2] if len(entry) > 2 else ParameterDescriptor()
        if not isinstance(descriptor, ParameterDescriptor):
            msg = (
                f"Third element {descriptor} at index {index} in parameters list "
                "is not a ParameterDescriptor."
            )
            raise TypeError(msg)
        if len(entry) == 1:
            # Only a name: such a parameter may change its type.
            _warn_name_only(name)
            descriptor.dynamic_typing = True
        if isinstance(value, Parameter.Type):
            self._declare_type(name, value, descriptor)
            value = None
        elif not descriptor.dynamic_typing:
            descriptor.type = Parameter.Type.from_parameter_value(value).value
            if descriptor.type == Parameter.Type.NOT_SET:
                msg = (
                    "Cannot declare a statically typed parameter with default value "
                    "of type PARAMETER_NOT_SET"
                )
                raise ValueError(msg)
        if not ignore_override and name in self._parameter_overrides:
            value = self._parameter_overrides[name].value
        return Parameter(name, value=value), descriptor

    @staticmethod
    def _declare_type(name: str, kind: Parameter.Type, descriptor: Any) -> None:
        if kind is Parameter.Type.NOT_SET:
            msg = f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET"
            raise ValueError(msg)
        if descriptor.dynamic_typing:
            msg = (
                f"When declaring parameter {{{name}}} passing a descriptor with"
                "`dynamic_typing=True` is not allowed when the parameter type is provided"
            )
            raise ValueError(msg)
        descriptor.type = kind.value


def _warn_name_only(name: str) -> None:
    """Warn as rclpy does when a parameter is declared by its name alone."""
    warnings.warn(
        f"when declaring parameter named '{name}', declaring a parameter only providing its name "
        "is deprecated. You have to either:\n"
        '\t- Pass a name and a default value different to "PARAMETER NOT SET"'
        " (and optionally a descriptor).\n"
        "\t- Pass a name and a parameter type.\n"
        "\t- Pass a name and a descriptor with `dynamic_typing=True",
        stacklevel=5,
    )
