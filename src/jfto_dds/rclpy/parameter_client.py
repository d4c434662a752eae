"""Reading and setting the parameters of other nodes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)

from .parameter import Parameter
from .qos import qos_profile_parameter_events, qos_profile_services_default
from .task import Future

_SERVICES = {
    "describe_parameters": DescribeParameters,
    "get_parameters": GetParameters,
    "get_parameter_types": GetParameterTypes,
    "list_parameters": ListParameters,
    "set_parameters": SetParameters,
    "set_parameters_atomically": SetParametersAtomically,
}


class AsyncParameterClient:
    """Calls the six parameter services of a node; every call returns a future."""

    def __init__(
        self,
        node: Any,
        remote_node_name: str,
        qos_profile: Any = qos_profile_services_default,
        callback_group: Any = None,
    ) -> None:
        self.remote_node_name = remote_node_name
        self.node = node
        self._clients = {
            name: node.create_client(
                srv_type,
                f"{remote_node_name}/{name}",
                qos_profile=qos_profile,
                callback_group=callback_group,
            )
            for name, srv_type in _SERVICES.items()
        }

    def services_are_ready(self) -> bool:
        """Whether all six services are there."""
        return all(client.service_is_ready() for client in self._clients.values())

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Wait for all six services; False on time-out."""
        end = None if timeout_sec is None else time.monotonic() + timeout_sec
        for client in self._clients.values():
            left = None if end is None else max(0.0, end - time.monotonic())
            if not client.wait_for_service(left):
                return False
        return True

    def _call(self, name: str, callback: Callable | None, **fields: Any) -> Future:
        request = _SERVICES[name].Request(**fields)
        future = self._clients[name].call_async(request)
        if callback is not None:
            future.add_done_callback(callback)
        return future

    def list_parameters(
        self,
        prefixes: list[str] | None = None,
        depth: int | None = None,
        callback: Callable[[Future], None] | None = None,
    ) -> Future:
        """Ask for the names of parameters."""
        return self._call("list_parameters", callback, prefixes=prefixes or [], depth=depth or 0)

    def get_parameters(
        self, names: list[str], callback: Callable[[Future], None] | None = None
    ) -> Future:
        """Ask for values."""
        return self._call("get_parameters", callback, names=names)

    def get_parameter_types(
        self, names: list[str], callback: Callable[[Future], None] | None = None
    ) -> Future:
        """Ask for types."""
        return self._call("get_parameter_types", callback, names=names)

    def describe_parameters(
        self, names: list[str], callback: Callable[[Future], None] | None = None
    ) -> Future:
        """Ask for descriptors."""
        return self._call("describe_parameters", callback, names=names)

    def set_parameters(
        self,
        parameters: Sequence[Any],
        callback: Callable[[Future], None] | None = None,
    ) -> Future:
        """Set parameters one by one."""
        return self._call("set_parameters", callback, parameters=_messages(parameters))

    def set_parameters_atomically(
        self,
        parameters: Sequence[Any],
        callback: Callable[[Future], None] | None = None,
    ) -> Future:
        """Set all parameters or none."""
        return self._call("set_parameters_atomically", callback, parameters=_messages(parameters))

    def delete_parameters(
        self, names: list[str], callback: Callable[[Future], None] | None = None
    ) -> Future:
        """Undeclare parameters."""
        empty = [Parameter(name).to_parameter_msg() for name in names]
        return self._call("set_parameters", callback, parameters=empty)

    def load_parameter_file(self, *_args: Any, **_kwargs: Any) -> Future:
        """Set parameters from a file, which is not supported."""
        msg = "jfto_dds does not support AsyncParameterClient.load_parameter_file"
        raise NotImplementedError(msg)

    def load_parameter_file_atomically(self, *_args: Any, **_kwargs: Any) -> Future:
        """Set parameters from a file, which is not supported."""
        msg = "jfto_dds does not support AsyncParameterClient.load_parameter_file_atomically"
        raise NotImplementedError(msg)

    def on_parameter_event(
        self, callback: Callable[[Any], None], qos_profile: Any = qos_profile_parameter_events
    ) -> Any:
        """Hear of parameter changes of all nodes."""
        return self.node.create_subscription(
            ParameterEvent, "/parameter_events", callback, qos_profile
        )


def _messages(parameters: Sequence[Any]) -> list[Any]:
    return [item.to_parameter_msg() if isinstance(item, Parameter) else item for item in parameters]
