"""Feeds a node's clock from ``/clock`` where ``use_sim_time`` is set."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rosgraph_msgs.msg import Clock as ClockMsg

from .clock_type import ClockType
from .parameter import Parameter
from .qos import QoSProfile, ReliabilityPolicy
from .time import Time

CLOCK_TOPIC = "/clock"
USE_SIM_TIME_NAME = "use_sim_time"


class TimeSource:
    """Connects the parameter ``use_sim_time``, the topic ``/clock`` and the clocks of a node."""

    def __init__(self, *, node: Any) -> None:
        self._node = node
        self._clocks: list[Any] = []
        self._subscription: Any = None
        self._last = Time(clock_type=ClockType.ROS_TIME)
        self._active = False
        if not node.has_parameter(USE_SIM_TIME_NAME):
            node.declare_parameter(USE_SIM_TIME_NAME, False)
        node.add_on_set_parameters_callback(self._on_parameters)
        self.ros_time_is_active = node.get_parameter(USE_SIM_TIME_NAME).value

    @property
    def ros_time_is_active(self) -> bool:
        """Whether the clocks follow ``/clock``."""
        return self._active

    @ros_time_is_active.setter
    def ros_time_is_active(self, enabled: bool) -> None:
        if enabled == self._active:
            return
        self._active = enabled
        if enabled:
            self._subscribe()
        for clock in self._clocks:
            clock._set_ros_time_is_active(enabled)

    def _subscribe(self) -> None:
        if self._subscription is None:
            self._subscription = self._node.create_subscription(
                ClockMsg,
                CLOCK_TOPIC,
                self._on_clock,
                QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
            )

    def attach_clock(self, clock: Any) -> None:
        """Drive a clock too."""
        clock.set_ros_time_override(self._last)
        clock._set_ros_time_is_active(self._active)
        self._clocks.append(clock)

    def detach_clock(self, clock: Any) -> None:
        """Leave a clock alone."""
        self._clocks.remove(clock)

    def destroy(self) -> None:
        """Stop listening."""
        self._clocks.clear()
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    def _on_clock(self, message: Any) -> None:
        self._last = Time.from_msg(message.clock)
        for clock in self._clocks:
            clock.set_ros_time_override(self._last)

    def _on_parameters(self, parameters: list[Parameter]) -> Any:
        for parameter in parameters:
            if parameter.name == USE_SIM_TIME_NAME:
                if parameter.type_ is not Parameter.Type.BOOL:
                    reason = f"{USE_SIM_TIME_NAME} parameter set to something besides a bool"
                    return SetParametersResult(successful=False, reason=reason)
                self.ros_time_is_active = parameter.value
        return SetParametersResult(successful=True)
