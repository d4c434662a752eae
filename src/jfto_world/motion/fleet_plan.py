"""The trajectories of one planning, gathered as they come."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.vehicle import TimedTrajectory


class FleetPlan:
    """What is known of a fleet's plan; complete once every UAV's trajectory begins together."""

    def __init__(self, uav_ids: tuple[str, ...]) -> None:
        self.uav_ids = uav_ids
        self._trajectories: dict[str, TimedTrajectory] = {}

    def take(self, uav_id: str, trajectory: TimedTrajectory) -> bool:
        """Take over a trajectory; False where it is the one known already."""
        known = self._trajectories.get(uav_id)
        self._trajectories[uav_id] = trajectory
        return known is None or not _same(known, trajectory)

    def trajectory(self, uav_id: str) -> TimedTrajectory:
        """Trajectory of a UAV, which must be known."""
        return self._trajectories[uav_id]

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
