"""Where the fleet will be: the plan, re-anchored at where each UAV was measured."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.records.vehicle import TimedTrajectory, VehiclePose
from jfto_msgs_py.types import Array
from jfto_world.motion.progress import sample
from jfto_world.motion.route_progress import RouteProgress

# Poses that come faster than this are used when somebody asks, else not looked at.
_LOOK_EVERY_S = 0.2


class FleetPrediction:
    """Planned trajectories and measured poses of a fleet.

    A late UAV keeps to its geometry and shifts in time: at time t it is predicted where the plan
    has it at t - lag. One that has reached its last waypoint, or has left its route, is predicted
    to stay where it was measured. Times are ns since the epoch, positions ENU metres.
    """

    def __init__(self) -> None:
        self._trajectories: dict[str, TimedTrajectory] = {}
        self._times_s: dict[str, Array] = {}
        self._poses: dict[str, VehiclePose] = {}
        self._progress: dict[str, RouteProgress] = {}
        self._looked_ns: dict[str, int] = {}

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
        """Take over a UAV's plan; its lag is found anew."""
        self._trajectories[uav_id] = trajectory
        self._times_s[uav_id] = trajectory.offset_ns / 1e9
        self._progress[uav_id] = RouteProgress(trajectory)
        self._looked_ns.pop(uav_id, None)

    def set_pose(self, uav_id: str, pose: VehiclePose) -> bool:
        """Take over a measured pose unless it is older than the last one; whether it was taken."""
        known = self._poses.get(uav_id)
        if known is not None and pose.stamp_ns <= known.stamp_ns:
            return False
        self._poses[uav_id] = pose
        if pose.stamp_ns - self._looked_ns.get(uav_id, 0) >= _LOOK_EVERY_S * 1e9:
            self._look(uav_id)
        return True

    def forget_poses(self) -> None:
        """Begin anew with the poses: the clock that stamps them was set back."""
        self._poses.clear()
        self._looked_ns.clear()
        self._progress = {uav: RouteProgress(plan) for uav, plan in self._trajectories.items()}

    def pose_stamp_ns(self, uav_id: str) -> int | None:
        """When the UAV was last measured, None if never."""
        pose = self._poses.get(uav_id)
        return None if pose is None else pose.stamp_ns

    def lag_s(self, uav_id: str) -> float:
        """By how much the UAV is behind its plan, seconds; negative if ahead."""
        progress = self._look(uav_id)
        return 0.0 if progress is None else progress.lag_s

    def is_off_route(self, uav_id: str) -> bool:
        """Whether the UAV has left its route before its end."""
        progress = self._look(uav_id)
        return progress is not None and progress.off_route and not progress.done

    def is_done(self, uav_id: str) -> bool:
        """Whether the UAV has reached its last waypoint."""
        progress = self._look(uav_id)
        return progress is not None and progress.done

    def from_start_m(self, uav_id: str) -> Array:
        """Where the UAV was measured (3,), from where its route begins; 0 if never."""
        pose = self._poses.get(uav_id)
        if pose is None:
            return np.zeros(3)
        away_m: Array = np.array(pose.position_m) - self._trajectories[uav_id].position_m[0]
        return away_m

    def fleet_lag_s(self, uav_ids: Sequence[str]) -> float | None:
        """Median lag of those of the UAVs that are under way; None where none is.

        One UAV that is held up, or off its route, does not move it; half of them do.
        """
        found = [
            progress.lag_s
            for uav_id in uav_ids
            if (progress := self._look(uav_id)) is not None and progress.following
        ]
        return median(found) if found else None

    def fresh(self, now_ns: int, stale_after_s: float) -> tuple[str, ...]:
        """UAVs with a trajectory and a pose that is not older than `stale_after_s`."""
        oldest = now_ns - round(stale_after_s * 1e9)
        return tuple(
            uav_id
            for uav_id in self.uav_ids
            if (stamp := self.pose_stamp_ns(uav_id)) is not None and stamp >= oldest
        )

    def positions(
        self, uav_ids: Sequence[str], instants_ns: NDArray[np.int64], *, stay: bool = False
    ) -> Array:
        """Predicted positions (instants, UAVs, 3).

        With `stay` a UAV that stands still on its route is predicted to stay there; without it is
        predicted to go on at once.
        """
        columns = []
        for uav_id in uav_ids:
            plan, progress = self._trajectories[uav_id], self._look(uav_id)
            if progress is not None and (progress.done or progress.off_route):
                here = np.array(self._poses[uav_id].position_m)
                columns.append(np.broadcast_to(here, (len(instants_ns), 3)))
                continue
            lag_s = 0.0 if progress is None else progress.lag_s
            at_s = (instants_ns - plan.start_ns) / 1e9 - lag_s
            if stay and progress is not None and progress.stands:
                at_s = np.full_like(at_s, at_s[0])
            columns.append(sample(self._times_s[uav_id], plan.position_m, at_s))
        return np.stack(columns, axis=1)

    def _look(self, uav_id: str) -> RouteProgress | None:
        """A UAV's progress by its last pose; None where its trajectory is not known."""
        progress, pose = self._progress.get(uav_id), self._poses.get(uav_id)
        if progress is None or pose is None:
            return progress
        if self._looked_ns.get(uav_id) != pose.stamp_ns:
            self._looked_ns[uav_id] = pose.stamp_ns
            progress.update(pose.stamp_ns, np.array(pose.position_m))
        return progress
