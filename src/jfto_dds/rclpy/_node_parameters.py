"""The parameters of a node: reading, setting, and the callbacks around that."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import (
    ListParametersResult,
    ParameterDescriptor,
    ParameterEvent,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMsg

from ._parameter_declaration import ParameterDeclaration
from ._parameter_descriptors import apply_descriptor
from .exceptions import (
    InvalidParameterValueException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from .parameter import PARAMETER_SEPARATOR_STRING, Parameter

_Callback = Callable[[list[Parameter]], Any]


class NodeParameters(ParameterDeclaration):
    """Parameter part of :class:`rclpy.node.Node`."""

    _parameters: dict[str, Parameter]
    _descriptors: dict[str, Any]
    _parameter_overrides: dict[str, Parameter]
    _allow_undeclared_parameters: bool
    _parameter_event_publisher: Any
    _clock: Any
    get_fully_qualified_name: Callable[[], str]

    def _init_parameters(self, allow_undeclared: bool) -> None:
        self._parameters = {}
        self._descriptors = {}
        self._parameter_overrides = {}
        self._allow_undeclared_parameters = allow_undeclared
        self._pre_set_parameters_callbacks: list[_Callback] = []
        self._on_set_parameters_callbacks: list[_Callback] = []
        self._post_set_parameters_callbacks: list[_Callback] = []

    def undeclare_parameter(self, name: str) -> None:
        """Forget a parameter; no callback runs and no event is published."""
        if not self.has_parameter(name):
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name]
        del self._descriptors[name]

    def has_parameter(self, name: str) -> bool:
        """Whether a parameter is declared."""
        return name in self._parameters

    def get_parameter_types(self, names: list[str]) -> list[Any]:
        """Types of several parameters, see :meth:`get_parameter_type`."""
        _check_names(names)
        return [self.get_parameter_type(name) for name in names]

    def get_parameter_type(self, name: str) -> Any:
        """Number of a parameter's type; raises ParameterNotDeclaredException."""
        if self.has_parameter(name):
            return self._parameters[name].type_.value
        if self._allow_undeclared_parameters:
            return Parameter.Type.NOT_SET
        raise ParameterNotDeclaredException(name)

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """Several parameters, see :meth:`get_parameter`."""
        _check_names(names)
        return [self.get_parameter(name) for name in names]

    def get_parameter(self, name: str) -> Parameter:
        """A parameter.

        Raises
        ------
        ParameterNotDeclaredException
            It is not declared, and the node does not allow that.
        ParameterUninitializedException
            It was declared with a type only and has no value.
        """
        if self.has_parameter(name):
            parameter = self._parameters[name]
            if (
                parameter.type_ is Parameter.Type.NOT_SET
                and not self._descriptors[name].dynamic_typing
            ):
                raise ParameterUninitializedException(name)
            return parameter
        if self._allow_undeclared_parameters:
            return Parameter(name, Parameter.Type.NOT_SET, None)
        raise ParameterNotDeclaredException(name)

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """A parameter, or an alternative where it has no value."""
        parameter = self._parameters.get(name)
        if parameter is None or parameter.type_ is Parameter.Type.NOT_SET:
            return alternative_value or Parameter(name, Parameter.Type.NOT_SET)
        return parameter

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Parameters whose names start with a prefix and a dot, by what follows."""
        start = prefix + PARAMETER_SEPARATOR_STRING if prefix else ""
        return {
            name[len(start) :]: parameter
            for name, parameter in self._parameters.items()
            if name.startswith(start)
        }

    def set_parameters(self, parameter_list: list[Parameter]) -> list[Any]:
        """Set parameters one by one; each has a result of its own.

        Raises
        ------
        ParameterNotDeclaredException
            One is not declared; those before it are set, those behind it are not.
        """
        return [self._set_checked([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Set all parameters or none."""
        return self._set_checked(list(parameter_list))

    def _set_checked(self, parameters: list[Parameter]) -> Any:
        if self._pre_set_parameters_callbacks:
            modified: list[Parameter] = []
            for callback in tuple(self._pre_set_parameters_callbacks):
                modified.extend(callback(parameters))
            parameters = modified
            if not parameters:
                return SetParametersResult(
                    successful=False,
                    reason="parameter list cannot be empty, this might be due to "
                    "pre_set_parameters_callback modifying the original parameters list.",
                )
        if not all(isinstance(parameter, Parameter) for parameter in parameters):
            msg = f"parameter must be instance of type '{Parameter!r}'"
            raise TypeError(msg)
        if not self._allow_undeclared_parameters and any(
            parameter.name not in self._parameters for parameter in parameters
        ):
            # rclpy's text has an empty list here.
            raise ParameterNotDeclaredException([])
        return self._set_common(parameters)

    def _set_common(
        self,
        parameters: list[Parameter],
        descriptors: dict[str, Any] | None = None,
        *,
        allow_not_set: bool = False,
    ) -> Any:
        """Check and store; new ``descriptors`` mean a declaration, which may set read-only ones."""
        for parameter in parameters:
            known = (self._descriptors if descriptors is None else descriptors).get(parameter.name)
            if known is not None:
                result = apply_descriptor(
                    parameter,
                    known,
                    declared=self.has_parameter(parameter.name),
                    check_read_only=descriptors is None,
                )
                if not result.successful:
                    return result
        for callback in tuple(self._on_set_parameters_callbacks):
            result = callback(parameters)
            if not result.successful:
                return result
        event = ParameterEvent(node=self.get_fully_qualified_name())
        for parameter in parameters:
            self._store(parameter, descriptors, event, allow_not_set)
        event.stamp = self._clock.now().to_msg()
        self._parameter_event_publisher.publish(event)
        for post in tuple(self._post_set_parameters_callbacks):
            post(parameters)
        return SetParametersResult(successful=True)

    def _store(
        self, parameter: Parameter, descriptors: Any, event: Any, allow_not_set: bool
    ) -> None:
        name = parameter.name
        if not allow_not_set and parameter.type_ is Parameter.Type.NOT_SET:
            event.deleted_parameters.append(parameter.to_parameter_msg())
            self._parameters.pop(name, None)
            self._descriptors.pop(name, None)
            return
        if descriptors is not None:
            self._descriptors[name] = descriptors[name]
        elif name not in self._descriptors:
            self._descriptors[name] = ParameterDescriptor(dynamic_typing=True)
        is_new = self.get_parameter_or(name).type_ is Parameter.Type.NOT_SET
        changes = event.new_parameters if is_new else event.changed_parameters
        changes.append(parameter.to_parameter_msg())
        self._parameters[name] = parameter

    def list_parameters(self, prefixes: list[str], depth: int) -> Any:
        """Names of parameters below prefixes, down to a depth (0: all)."""
        if not isinstance(prefixes, list):
            msg = "The prefixes argument must be a list"
            raise TypeError(msg)
        if not all(isinstance(prefix, str) for prefix in prefixes):
            msg = "All prefixes must be instances of type str"
            raise TypeError(msg)
        if not isinstance(depth, int):
            msg = "The depth must be instance of type int"
            raise TypeError(msg)
        if depth < 0:
            msg = "The depth must be greater than or equal to zero"
            raise ValueError(msg)
        result = ListParametersResult()
        for name in self._parameters:
            if not _is_listed(name, prefixes, depth):
                continue
            result.names.append(name)
            prefix = name.rpartition(PARAMETER_SEPARATOR_STRING)[0]
            if prefix and prefix not in result.prefixes:
                result.prefixes.append(prefix)
        return result

    def describe_parameter(self, name: str) -> Any:
        """The descriptor of a parameter; raises ParameterNotDeclaredException."""
        if name in self._descriptors:
            return self._descriptors[name]
        if self._allow_undeclared_parameters:
            return ParameterDescriptor()
        raise ParameterNotDeclaredException(name)

    def describe_parameters(self, names: list[str]) -> list[Any]:
        """Descriptors of several parameters."""
        return [self.describe_parameter(name) for name in names]

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        """Replace a descriptor, and perhaps the value; returns the value in force."""
        if not self.has_parameter(name):
            if not self._allow_undeclared_parameters:
                raise ParameterNotDeclaredException(name)
            return self.get_parameter(name).get_parameter_value()
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        candidates = [self.get_parameter(name)]
        if alternative_value is not None:
            message = ParameterMsg(name=name, value=alternative_value)
            candidates.append(Parameter.from_parameter_msg(message))
        for candidate in candidates:
            result = apply_descriptor(candidate, descriptor, declared=True, check_read_only=False)
            if result.successful:
                self._parameters[name] = candidate
                break
        else:
            raise InvalidParameterValueException(name, candidates[-1].value, result.reason)
        self._descriptors[name] = descriptor
        return self.get_parameter(name).get_parameter_value()

    def add_pre_set_parameters_callback(self, callback: _Callback) -> None:
        """Change the list before it is checked; last added runs first."""
        self._pre_set_parameters_callbacks.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: _Callback) -> None:
        """Accept or refuse new values; last added runs first."""
        self._on_set_parameters_callbacks.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: _Callback) -> None:
        """Hear of values that were set; last added runs first."""
        self._post_set_parameters_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: _Callback) -> None:
        """Take a callback back; raises ValueError where it is not there."""
        self._pre_set_parameters_callbacks.remove(callback)

    def remove_on_set_parameters_callback(self, callback: _Callback) -> None:
        """Take a callback back; raises ValueError where it is not there."""
        self._on_set_parameters_callbacks.remove(callback)

    def remove_post_set_parameters_callback(self, callback: _Callback) -> None:
        """Take a callback back; raises ValueError where it is not there."""
        self._post_set_parameters_callbacks.remove(callback)


def _check_names(names: list[str]) -> None:
    if not all(isinstance(name, str) for name in names):
        msg = "All names must be instances of type str"
        raise TypeError(msg)


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    if not prefixes:
        return depth == 0 or name.count(PARAMETER_SEPARATOR_STRING) < depth
    for prefix in prefixes:
        if name == prefix:
            return True
        start = prefix + PARAMETER_SEPARATOR_STRING
        if name.startswith(start):
            below = name[len(start) :].count(PARAMETER_SEPARATOR_STRING)
            if depth == 0 or below < depth:
                return True
    return False
