"""Where the fleet will be: the plan, re-anchored at where each UAV was measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.vehicle import TimedTrajectory, VehiclePose
from jfto_world.motion.progress import progress_time, sample

Array = NDArray[np.float64]

# How far a UAV's clock along its route may jump between two poses, seconds.
WINDOW_S = 10.0


class FleetPrediction:
    """Planned trajectories and measured poses of a fleet.

    A late UAV keeps to its geometry and shifts in time: at time t it is predicted where the plan
    has it at t - lag. Times are ns since the epoch, positions ENU metres.
    """

    def __init__(self) -> None:
        self._trajectories: dict[str, TimedTrajectory] = {}
        self._poses: dict[str, VehiclePose] = {}
        self._lag_s: dict[str, float] = {}

    @property
    def uav_ids(self) -> tuple[str, ...]:
        """UAVs whose trajectory is known, sorted."""
        return tuple(sorted(self._trajectories))

    @property
    def start_ns(self) -> int:
        """Earliest start of all trajectories; the fleet's time zero."""
        return min(each.start_ns for each in self._trajectories.values())

    @property
    def end_ns(self) -> int:
        """When the last UAV reaches the end of its trajectory, as planned."""
        return max(each.start_ns + int(each.offset_ns[-1]) for each in self._trajectories.values())

    def set_trajectory(self, uav_id: str, trajectory: TimedTrajectory) -> None:
        """Take over a UAV's plan; its lag starts anew."""
        self._trajectories[uav_id] = trajectory
        self._lag_s[uav_id] = 0.0

    def set_pose(self, uav_id: str, pose: VehiclePose) -> bool:
        """Take over a measured pose unless it is older than the last one; whether it was taken."""
        known = self._poses.get(uav_id)
        if known is not None and pose.stamp_ns <= known.stamp_ns:
            return False
        self._poses[uav_id] = pose
        if uav_id in self._trajectories:
            self._lag_s[uav_id] = self._measure_lag(uav_id, pose)
        return True

    def pose_stamp_ns(self, uav_id: str) -> int | None:
        """When the UAV was last measured, None if never."""
        pose = self._poses.get(uav_id)
        return None if pose is None else pose.stamp_ns

    def lag_s(self, uav_id: str) -> float:
        """By how much the UAV is behind its plan, seconds; negative if ahead."""
        return self._lag_s.get(uav_id, 0.0)

    def fresh(self, now_ns: int, stale_after_s: float) -> tuple[str, ...]:
        """UAVs with a trajectory and a pose that is not older than `stale_after_s`."""
        oldest = now_ns - round(stale_after_s * 1e9)
        return tuple(
            uav_id
            for uav_id in self.uav_ids
            if (stamp := self.pose_stamp_ns(uav_id)) is not None and stamp >= oldest
        )

    def positions(self, uav_ids: Sequence[str], instants_ns: NDArray[np.int64]) -> Array:
        """Predicted positions (instants, UAVs, 3)."""
        columns = []
        for uav_id in uav_ids:
            plan = self._trajectories[uav_id]
            at_s = (instants_ns - plan.start_ns) / 1e9 - self._lag_s[uav_id]
            columns.append(sample(plan.offset_ns / 1e9, plan.position_m, at_s))
        return np.stack(columns, axis=1)

    def _measure_lag(self, uav_id: str, pose: VehiclePose) -> float:
        plan = self._trajectories[uav_id]
        clock_s = (pose.stamp_ns - plan.start_ns) / 1e9
        expected_s = clock_s - self._lag_s[uav_id]
        reached_s = progress_time(
            plan.offset_ns / 1e9,
            plan.position_m,
            np.asarray(pose.position_m),
            expected_s,
            WINDOW_S,
        )
        # Before its start and after its end a UAV is where it should be: no lag to be seen.
        if expected_s < 0 or reached_s >= plan.offset_ns[-1] / 1e9:
            return min(self._lag_s[uav_id], max(clock_s - reached_s, 0.0))
        return clock_s - reached_s
