"""What a vehicle is told to fly and what it reports."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.types import Array

# No local frame reaches further: a quarter of the way around the Earth.
FARTHEST_M = 1e7


@dataclass(frozen=True, eq=False)
class TimedPath:
    """Waypoints of one UAV in ENU metres with planned arrival times (ns since the epoch).

    The first point is the pad. `yaw_deg` is clockwise from north, `pitch_deg` the camera's.
    """

    points_m: Array
    arrival_ns: NDArray[np.int64]
    yaw_deg: Array

    def __post_init__(self) -> None:
        count = len(self.points_m)
        if self.points_m.shape != (count, 3) or count == 0:
            raise MessageError("path.poses", f"shape is {self.points_m.shape}, expected (M ≥ 1, 3)")
        if self.arrival_ns.shape != (count,) or self.yaw_deg.shape != (count,):
            raise MessageError("path.poses", "needs one stamp and one heading per point")
        if not (np.isfinite(self.points_m).all() and np.isfinite(self.yaw_deg).all()):
            raise MessageError("path.poses", "holds a number that is not finite")
        _check_near("path.poses", self.points_m)
        if (np.diff(self.arrival_ns) < 0).any():
            raise MessageError("path.poses", "stamps go backward")


@dataclass(frozen=True, eq=False)
class TimedTrajectory:
    """Samples of a trajectory: position, velocity, acceleration (M, 3) in ENU, SI units.

    `offset_ns` counts from `start_ns` (ns since the epoch) and grows.
    """

    start_ns: int
    offset_ns: NDArray[np.int64]
    position_m: Array
    velocity_mps: Array
    acceleration_mps2: Array

    def __post_init__(self) -> None:
        count = len(self.offset_ns)
        if count == 0:
            raise MessageError("trajectory.points", "is empty")
        for name in ("position_m", "velocity_mps", "acceleration_mps2"):
            array = getattr(self, name)
            if array.shape != (count, 3):
                raise MessageError(f"trajectory.{name}", f"shape is {array.shape}")
            if not np.isfinite(array).all():
                raise MessageError(f"trajectory.{name}", "holds a number that is not finite")
        _check_near("trajectory.position_m", self.position_m)
        if (np.diff(self.offset_ns) <= 0).any():
            raise MessageError("trajectory.points", "time_from_start does not grow")


@dataclass(frozen=True)
class VehiclePose:
    """Measured position of a UAV in ENU metres at `stamp_ns` (ns since the epoch).

    `yaw_deg` is clockwise from north.
    """

    stamp_ns: int
    position_m: tuple[float, float, float]
    yaw_deg: float

    def __post_init__(self) -> None:
        if not np.isfinite((*self.position_m, self.yaw_deg)).all():
            raise MessageError("pose.position", "holds a number that is not finite")
        _check_near("pose.position", np.array(self.position_m))


def _check_near(field: str, positions_m: Array) -> None:
    """Refuse places that cannot be local: squares of wild numbers overflow further on."""
    if (np.abs(positions_m) > FARTHEST_M).any():
        raise MessageError(field, f"is beyond {FARTHEST_M:.0e} m from the origin")
