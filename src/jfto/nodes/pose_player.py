"""Poses of a fleet that flies exactly as planned, where there are no vehicles."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto.node_options import PosePlayerOptions
from jfto_msgs_py.records.vehicle import VehiclePose
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.diagnostics import OK, WARN, Status
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.vehicle import decode_trajectory, encode_pose
from jfto_msgs_py.scenario import Scenario
from jfto_world.motion.progress import sample


class PosePlayerNode(GraphNode[PosePlayerOptions]):
    """Publishes each UAV's planned position as its pose."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__("pose_player", PosePlayerOptions, **arguments)

    def build(self, scenario: Scenario, options: PosePlayerOptions) -> None:
        """A trajectory in and a pose out per UAV."""
        self._ids = scenario.fleet.ids
        self._trajectories: dict[str, Any] = {}
        for uav in self._ids:
            self.create_subscription(
                MultiDOFJointTrajectory,
                topics.trajectory(uav),
                partial(self._on_trajectory, uav),
                qos.latched(),
            )
        self._poses = {
            uav: self.create_lifecycle_publisher(PoseStamped, topics.pose(uav), qos.sensor())
            for uav in self._ids
        }
        self.create_timer(1 / options.rate_hz, self._play)

    def _on_trajectory(self, uav: str, message: Any) -> None:
        trajectory = self.intake.take(topics.trajectory(uav), decode_trajectory, message)
        if trajectory is not None:
            self._trajectories[uav] = trajectory

    def _play(self) -> None:
        now_ns = self.now_ns()
        for uav, plan in self._trajectories.items():
            at_s = np.array([(now_ns - plan.start_ns) / 1e9, (now_ns - plan.start_ns) / 1e9 + 0.1])
            here, ahead = sample(plan.offset_ns / 1e9, plan.position_m, at_s).tolist()
            east, north = ahead[0] - here[0], ahead[1] - here[1]
            yaw_deg = float(np.degrees(np.arctan2(east, north))) if east or north else 0.0
            pose = VehiclePose(now_ns, (here[0], here[1], here[2]), yaw_deg)
            self._poses[uav].publish(encode_pose(pose))

    def statuses(self, now_ns: int) -> list[Status]:
        """Who is played."""
        del now_ns
        played = len(self._trajectories)
        node = Status("", OK, f"{played} UAVs", self.intake.facts("/"))
        return [
            node,
            *(
                Status(uav, OK, "flies as planned")
                if uav in self._trajectories
                else Status(uav, WARN, "no trajectory yet")
                for uav in self._ids
            ),
        ]
