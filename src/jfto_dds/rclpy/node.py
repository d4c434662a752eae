"""Nodes."""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, ParameterEvent

from . import _remapping
from ._arguments import parse_arguments
from ._names import node_name_problem
from ._node_endpoints import NodeEndpoints
from ._node_graph import NodeGraph
from ._node_parameters import NodeParameters
from ._parameter_descriptors import PARAM_REL_TOL
from ._parameter_yaml import node_key_matches
from ._rclpy_pybind11 import DESTROYED_TEXT, RCLError
from ._rosout import attach_rosout, detach_rosout
from .callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from .clock import ROSClock
from .exceptions import InvalidHandle, InvalidNodeNameException, NotInitializedException
from .logging import get_logger
from .logging_service import LoggingService
from .parameter import Parameter
from .parameter_service import ParameterService
from .qos import qos_profile_parameter_events
from .time_source import TimeSource
from .type_description_service import TypeDescriptionService
from .utilities import get_default_context
from .validate_namespace import validate_namespace


class Node(NodeParameters, NodeEndpoints, NodeGraph):
    """A participant in the ROS graph: parameters, topics, services, timers."""

    PARAM_REL_TOL = PARAM_REL_TOL

    def __init__(
        self,
        node_name: str,
        *,
        context: Any = None,
        cli_args: list[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        start_parameter_services: bool = True,
        parameter_overrides: list[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        self._context = get_default_context() if context is None else context
        self._destroyed = False
        self._executor_reference: Any = None
        self._default_callback_group = MutuallyExclusiveCallbackGroup()
        self._rate_group = ReentrantCallbackGroup()
        self._init_parameters(allow_undeclared_parameters)
        self._init_endpoints()
        if not self._context.ok():
            msg = "cannot create node"
            raise NotInitializedException(msg)
        overrides = self._name_and_remap(node_name, namespace, cli_args, use_global_arguments)
        self._participant = self._context._get_participant()
        self._entry = self._participant.add_node(self._namespace, self._name)
        self._logger = get_logger(self._logger_name())
        if enable_rosout and self._context._arguments.rosout:
            attach_rosout(self)
        self._clock = ROSClock()
        self._parameter_event_publisher = self.create_publisher(
            ParameterEvent, "/parameter_events", qos_profile_parameter_events
        )
        self._parameter_overrides = overrides
        if parameter_overrides is not None:
            overrides.update({parameter.name: parameter for parameter in parameter_overrides})
        if automatically_declare_parameters_from_overrides:
            self.declare_parameters(
                "",
                [
                    (name, parameter.value, ParameterDescriptor())
                    for name, parameter in overrides.items()
                ],
                ignore_override=True,
            )
        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(self._clock)
        if start_parameter_services:
            self._parameter_service = ParameterService(self)
        if enable_logger_service:
            self._logger_service = LoggingService(self)
        self._type_description_service = TypeDescriptionService(self)

    def _name_and_remap(
        self,
        node_name: str,
        namespace: str | None,
        cli_args: list[str] | None,
        use_global_arguments: bool,
    ) -> dict[str, Parameter]:
        """Work out name, namespace, remap rules and the parameters that the command line sets."""
        if node_name is None:
            msg = "error creating node: name argument is null"
            raise RCLError(msg)
        if not isinstance(node_name, str):
            msg = (
                "__init__(): incompatible constructor arguments. The following argument types are "
                "supported:\n    1. rclpy._rclpy_pybind11.Node(arg0: str, arg1: str, arg2: "
                "rclpy._rclpy_pybind11.Context, arg3: object, arg4: bool, arg5: bool)\n\n"
                f"Invoked with: {node_name!r}"
            )
            raise TypeError(msg)
        problem = node_name_problem(node_name)
        if problem is not None:
            raise InvalidNodeNameException(node_name, *problem)
        namespace = namespace or "/"
        namespace = namespace if namespace.startswith("/") else f"/{namespace}"
        validate_namespace(namespace)
        sources = [parse_arguments(cli_args)] if cli_args is not None else []
        if use_global_arguments:
            sources.append(self._context._arguments)
        rules = [rule for source in sources for rule in source.remappings]
        self._namespace = _remapping.remap_identity(rules, "namespace", namespace, node_name)
        self._name = _remapping.remap_identity(rules, "node", node_name, node_name)
        self._remap_rules = [rule for rule in rules if rule.node in ("", node_name, self._name)]
        full_name = self._full_name()
        found: dict[str, Parameter] = {}
        # The node's own arguments come last, so that they win.
        for source in reversed(sources):
            for key, values in source.parameters.items():
                if node_key_matches(key, full_name):
                    found.update(
                        {name: Parameter(name, value=value) for name, value in values.items()}
                    )
        return found

    def _full_name(self) -> str:
        return f"{'' if self._namespace == '/' else self._namespace}/{self._name}"

    def _logger_name(self) -> str:
        return self._full_name()[1:].replace("/", ".")

    def _require(self) -> None:
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)

    @property
    def publishers(self) -> Iterator[Any]:
        """Publishers of this node."""
        yield from self._publishers

    @property
    def subscriptions(self) -> Iterator[Any]:
        """Subscriptions of this node."""
        yield from self._subscriptions

    @property
    def clients(self) -> Iterator[Any]:
        """Service clients of this node."""
        yield from self._clients

    @property
    def services(self) -> Iterator[Any]:
        """Service servers of this node."""
        yield from self._services

    @property
    def timers(self) -> Iterator[Any]:
        """Timers of this node."""
        yield from self._timers

    @property
    def guards(self) -> Iterator[Any]:
        """Guard conditions of this node."""
        yield from self._guards

    @property
    def waitables(self) -> Iterator[Any]:
        """Event handlers of this node's endpoints."""
        yield from self._waitables

    @property
    def executor(self) -> Any:
        """The executor in charge of this node, or None."""
        return None if self._executor_reference is None else self._executor_reference()

    @executor.setter
    def executor(self, new_executor: Any) -> None:
        current = self.executor
        if current is new_executor:
            return
        self._executor_reference = None if new_executor is None else weakref.ref(new_executor)
        if current is not None:
            current.remove_node(self)
        if new_executor is not None:
            new_executor.add_node(self)

    def _wake_executor(self) -> None:
        # Called from DDS threads too.
        reference = self._executor_reference
        executor = None if reference is None else reference()
        if executor is not None:
            executor.wake()

    @property
    def context(self) -> Any:
        """The context that the node belongs to."""
        return self._context

    @property
    def default_callback_group(self) -> Any:
        """The group of callbacks that name no other: one runs at a time."""
        return self._default_callback_group

    @property
    def handle(self) -> Node:
        """Stands for rcl's node."""
        self._require()
        return self

    def get_name(self) -> str:
        """The node's name."""
        self._require()
        return self._name

    def get_namespace(self) -> str:
        """The node's namespace."""
        self._require()
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        """Namespace and name."""
        self._require()
        return self._full_name()

    def get_clock(self) -> Any:
        """The node's clock, which follows ``/clock`` where ``use_sim_time`` is set."""
        return self._clock

    def get_logger(self) -> Any:
        """The node's logger."""
        return self._logger

    def destroy_node(self) -> None:
        """Take the node off the network; doing it again changes nothing."""
        if self._destroyed:
            return
        if self.executor is not None:
            self.executor.remove_node(self)
        self._time_source.destroy()
        detach_rosout(self)
        self._destroy_endpoints()
        self._participant.remove_node(self._entry)
        self._destroyed = True

    def __enter__(self) -> Node:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.destroy_node()
