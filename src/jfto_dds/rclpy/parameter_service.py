"""The six parameter services of a node."""

from __future__ import annotations

import weakref
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)

from .exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from .parameter import Parameter
from .qos import qos_profile_parameters


class ParameterService:
    """Lets other nodes read and set parameters."""

    def __init__(self, node: Any) -> None:
        self._node_reference = weakref.ref(node)
        for srv_type, name, callback in (
            (DescribeParameters, "describe_parameters", self._describe),
            (GetParameters, "get_parameters", self._get),
            (GetParameterTypes, "get_parameter_types", self._get_types),
            (ListParameters, "list_parameters", self._list),
            (SetParameters, "set_parameters", self._set),
            (SetParametersAtomically, "set_parameters_atomically", self._set_atomically),
        ):
            node.create_service(
                srv_type,
                f"{node.get_name()}/{name}",
                callback,
                qos_profile=qos_profile_parameters,
            )

    def _node(self) -> Any:
        node = self._node_reference()
        if node is None:
            msg = "Expected valid node weak reference"
            raise ReferenceError(msg)
        return node

    def _describe(self, request: Any, response: Any) -> Any:
        try:
            response.descriptors = self._node().describe_parameters(list(request.names))
        except ParameterNotDeclaredException:
            # One unknown name empties the whole answer, here and below, as in rclpy.
            response.descriptors = []
        return response

    def _get(self, request: Any, response: Any) -> Any:
        node = self._node()
        try:
            response.values = [
                node.get_parameter(name).get_parameter_value() for name in request.names
            ]
        except (ParameterNotDeclaredException, ParameterUninitializedException):
            response.values = []
        return response

    def _get_types(self, request: Any, response: Any) -> Any:
        try:
            response.types = [
                int(kind) for kind in self._node().get_parameter_types(list(request.names))
            ]
        except ParameterNotDeclaredException:
            response.types = []
        return response

    def _list(self, request: Any, response: Any) -> Any:
        response.result = self._node().list_parameters(list(request.prefixes), request.depth)
        return response

    def _set(self, request: Any, response: Any) -> Any:
        node = self._node()
        results = []
        for message in request.parameters:
            parameter = Parameter.from_parameter_msg(message)
            try:
                results.extend(node.set_parameters([parameter]))
            except ParameterNotDeclaredException as error:
                results.append(SetParametersResult(successful=False, reason=str(error)))
        response.results = results
        return response

    def _set_atomically(self, request: Any, response: Any) -> Any:
        parameters = [Parameter.from_parameter_msg(message) for message in request.parameters]
        try:
            response.result = self._node().set_parameters_atomically(parameters)
        except ParameterNotDeclaredException as error:
            response.result = SetParametersResult(successful=False, reason=str(error))
        return response
