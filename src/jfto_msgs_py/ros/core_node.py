"""A node around a pure core: messages in, records on; outputs back, messages out; one timer."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any, Generic, Protocol, TypeVar

from geometry_msgs.msg import PoseStamped
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.core import Core, Made
from jfto_msgs_py.records.vehicle import TimedTrajectory, VehiclePose
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.intake import Input
from jfto_msgs_py.ros.vehicle import decode_pose, decode_trajectory

Options = TypeVar("Options")
_LATER_S = 3600.0


class CoreNode(GraphNode[Options], Generic[Options, Made]):
    """Feeds a core as messages come and publishes what it makes.

    A subclass calls `connect` at the end of `build`.
    """

    def publish(self, made: Made) -> None:
        """Publish what a step made, the most urgent first."""
        raise NotImplementedError

    def connect(self, core: Core[Made], inputs: Iterable[Input]) -> None:
        """Subscribe to what the core takes, and make the timer that wakes it."""
        self._core = core
        for each in inputs:
            self.create_subscription(
                each.kind, each.topic, partial(self._on_message, each), each.qos
            )
        self._timer = self.create_timer(_LATER_S, self.step)
        self._timer.cancel()

    def activated(self) -> None:
        """Do what has become due meanwhile."""
        self.step()

    def step(self) -> None:
        """Let the core step, publish what it made, and wait for the next time.

        Under the events executor a timer may fire twice for one jump of simulated time: a step for
        which nothing is due is none.
        """
        if not self.is_active:
            self._timer.cancel()
            return
        now_ns = self.now_ns()
        if not now_ns:
            self._wake_at(1)  # as soon as simulated time has come
            return
        made = self._core.step(now_ns)
        self.publish(made)
        self._wake_at(made.wake_ns)

    def _wake_at(self, wake_ns: int | None) -> None:
        if wake_ns is None:
            self._timer.cancel()
            return
        self._timer.timer_period_ns = max(wake_ns - self.now_ns(), 1)
        self._timer.reset()

    def _on_message(self, each: Input, message: Any) -> None:
        now_ns = self.now_ns()
        taken = self.intake.hand_over(each, message, now_ns)
        if taken and self.is_active and self._core.due(now_ns):
            self.step()


class FollowsFleet(Protocol):
    """A core that follows a fleet by its plans and poses."""

    def take_trajectory(self, uav_id: str, trajectory: TimedTrajectory, now_ns: int, /) -> None:
        """Take a UAV's plan over."""

    def take_pose(self, uav_id: str, pose: VehiclePose, now_ns: int, /) -> None:
        """Take a measured pose over."""


def fleet_inputs(core: FollowsFleet, uav_ids: Iterable[str]) -> list[Input]:
    """Trajectories and poses of a fleet, as inputs of a core."""
    latched, sensor = qos.latched(), qos.sensor()
    inputs = []
    for uav in uav_ids:
        plan, pose = topics.trajectory(uav), topics.pose(uav)
        take_plan, take_pose = partial(core.take_trajectory, uav), partial(core.take_pose, uav)
        inputs += [
            Input(MultiDOFJointTrajectory, plan, latched, decode_trajectory, take_plan),
            Input(PoseStamped, pose, sensor, decode_pose, take_pose),
        ]
    return inputs
