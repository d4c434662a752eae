"""A trajectory: quintic Bezier segments in time, and what it asks of the vehicle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array


@dataclass(frozen=True)
class Motion:
    """Position, velocity, acceleration and jerk at T instants, each (T, 3), SI units, ENU."""

    position_m: Array
    velocity_mps: Array
    acceleration_mps2: Array
    jerk_mps3: Array


@dataclass(frozen=True)
class Trajectory:
    """Segments flown one after another; at rest before the first and after the last.

    `control_m` (S, 6, 3) control points, `duration_s` (S,), `waypoint_s` (M,) when each point of
    the route is passed (its hold included), counted like everything else from lift-off;
    `delay_s` is how long the vehicle waits at its start.
    """

    control_m: Array
    duration_s: Array
    waypoint_s: Array
    delay_s: float = 0.0

    @property
    def knots_s(self) -> Array:
        """Times of the joints between segments, (S + 1,)."""
        return self.delay_s + np.concatenate([[0.0], np.cumsum(self.duration_s)])

    @property
    def end_s(self) -> float:
        """Time at which the vehicle comes to rest at its last point, delay included."""
        return self.delay_s + float(np.sum(self.duration_s))

    def motion(self, times_s: Array) -> Motion:
        """Motion at times from lift-off; at rest outside of the flight."""
        times, which, share = self._locate(times_s)
        knots = self.knots_s
        span = self.duration_s[which]
        outside = ((times < knots[0]) | (times > knots[-1]))[:, None]
        parts, points = [], self.control_m[which]
        for order in range(4):
            value = _bernstein(points, share)
            parts.append(value if order == 0 else np.where(outside, 0.0, value))
            points = (5 - order) * np.diff(points, axis=1) / span[:, None, None]
        return Motion(*parts)

    def positions(self, times_s: Array) -> Array:
        """Positions at times from lift-off, (T, 3)."""
        _, which, share = self._locate(times_s)
        return _bernstein(self.control_m[which], share)

    def _locate(self, times_s: Array) -> tuple[Array, NDArray[np.intp], Array]:
        """Times (T,), the segment of each, and where in it, 0 to 1."""
        times = np.atleast_1d(np.asarray(times_s, dtype=np.float64))
        knots = self.knots_s
        which = np.searchsorted(knots, times, side="right") - 1
        which = np.clip(which, 0, len(self.duration_s) - 1)
        return times, which, np.clip((times - knots[which]) / self.duration_s[which], 0.0, 1.0)

    def delayed(self, delay_s: float) -> Trajectory:
        """The same flight, begun `delay_s` later."""
        if delay_s < 0:
            raise InputError(f"delay_s is {delay_s}, must not be negative.")
        shift = self.delay_s + delay_s
        return replace(self, delay_s=shift, waypoint_s=self.waypoint_s + delay_s)

    def slowed(self, factor: float) -> Trajectory:
        """The same path in `factor` >= 1 times the time: no limit is exceeded that was kept."""
        if not factor >= 1:
            raise InputError(f"factor is {factor}, must be at least 1.")
        passed = self.delay_s + (self.waypoint_s - self.delay_s) * factor
        return replace(self, duration_s=self.duration_s * factor, waypoint_s=passed)

    def as_record(self) -> dict[str, Any]:
        """Plain lists and numbers, for the plan file."""
        return {
            "kind": "bezier5",
            "delay_s": self.delay_s,
            "duration_s": self.duration_s.tolist(),
            "waypoint_s": self.waypoint_s.tolist(),
            "control_m": self.control_m.tolist(),
        }

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Trajectory:
        """Inverse of `as_record`; raises InputError where the record is not one of ours."""
        if record.get("kind") != "bezier5":
            raise InputError(f"trajectory kind is {record.get('kind')!r}, must be 'bezier5'.")
        control = np.asarray(record["control_m"], dtype=np.float64)
        duration = np.asarray(record["duration_s"], dtype=np.float64)
        if control.shape != (len(duration), 6, 3):
            raise InputError(
                f"trajectory control_m has shape {control.shape}, must be ({len(duration)}, 6, 3)."
            )
        passed = np.asarray(record["waypoint_s"], dtype=np.float64)
        return cls(control, duration, passed, float(record["delay_s"]))


def _bernstein(points: Array, share: Array) -> Array:
    """De Casteljau: values (T, 3) of curves (T, n, 3) at (T,) parameters in [0, 1]."""
    s = share[:, None, None]
    while points.shape[1] > 1:
        points = (1.0 - s) * points[:, :-1] + s * points[:, 1:]
    return points[:, 0]
