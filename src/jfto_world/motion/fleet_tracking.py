"""A fleet as its trajectories and poses come in: what is planned, and where everybody is."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.core import ClockWatch
from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.vehicle import TimedTrajectory, VehiclePose
from jfto_world.motion.fleet_prediction import FleetPrediction

# By how much the clocks of two computers may differ.
AHEAD_S = 1.0
# Simulated time comes in ticks, which a busy reader may get after the poses that they belong to.
AHEAD_SIMULATED_S = 10.0


class FleetTracking:
    """Takes records over, refuses what cannot be, and knows whether the fleet has a plan.

    It has one once every UAV's trajectory is of one planning: all of those begin together.
    `prediction` says where the fleet will be. A pose stamped more than `ahead_s` ahead of the clock
    is refused. Times are ns since the epoch.
    """

    def __init__(self, uav_ids: tuple[str, ...], ahead_s: float = AHEAD_S) -> None:
        self.uav_ids = uav_ids
        self.prediction = FleetPrediction()
        self._ahead_s = ahead_s
        self._trajectories: dict[str, TimedTrajectory] = {}
        self._clock = ClockWatch()

    def take_trajectory(self, uav_id: str, trajectory: TimedTrajectory) -> bool:
        """Take over a trajectory; False where it is the one known already."""
        known = self._trajectories.get(uav_id)
        if known is not None and _same(known, trajectory):
            return False
        self._trajectories[uav_id] = trajectory
        self.prediction.set_trajectory(uav_id, trajectory)
        return True

    def take_pose(self, uav_id: str, pose: VehiclePose, now_ns: int) -> None:
        """Take over a measured pose unless there is a newer one.

        Raises MessageError for one from the future, which would hide all that come after it.
        `now_ns` is 0 where the clock has not begun.
        """
        ahead_s = (pose.stamp_ns - now_ns) / 1e9
        if now_ns and ahead_s > self._ahead_s:
            raise MessageError("header.stamp", f"is {ahead_s:.1f} s ahead of this clock")
        self.prediction.set_pose(uav_id, pose)

    def follow_clock(self, now_ns: int) -> int:
        """By how much the clock was set back since last asked, ns, 0 if it was not.

        Poses that were stamped by the clock before that are forgotten.
        """
        back_ns = self._clock.set_back_by_ns(now_ns)
        if back_ns:
            self.prediction.forget_poses()
        return back_ns

    @property
    def trajectories(self) -> dict[str, TimedTrajectory]:
        """Trajectories by UAV, as far as they are known."""
        return dict(self._trajectories)

    @property
    def missing(self) -> tuple[str, ...]:
        """UAVs without a trajectory, or with one of an older planning."""
        if not self._trajectories:
            return self.uav_ids
        newest = max(each.start_ns for each in self._trajectories.values())
        return tuple(
            uav_id
            for uav_id in self.uav_ids
            if uav_id not in self._trajectories or self._trajectories[uav_id].start_ns != newest
        )

    @property
    def complete(self) -> bool:
        """Whether all UAVs have a trajectory of one planning."""
        return not self.missing

    @property
    def duration_s(self) -> float:
        """From lift-off until the last UAV has reached its end."""
        return max(int(each.offset_ns[-1]) for each in self._trajectories.values()) / 1e9


def _same(one: TimedTrajectory, other: TimedTrajectory) -> bool:
    return one.start_ns == other.start_ns and all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in ("offset_ns", "position_m", "velocity_mps", "acceleration_mps2")
    )
