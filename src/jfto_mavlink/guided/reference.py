"""Where a UAV should be at an instant of its trajectory, whether it can be, and how it gets there.

From where it is onto its trajectory: an offset that fades out smoothly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_mavlink.errors import MissionError
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_msgs_py.types import Array

# Samples this close are of a smooth curve; farther apart they are corners of straight legs.
SMOOTH_S = 1.0
CHECK_STEP_S = 0.1
# A curve fitted through samples swings a little beyond what it was sampled from.
TOLERANCE = 1.15


@dataclass(frozen=True, eq=False)
class Reference:
    """Position, velocity and acceleration in ENU (…, 3), SI units."""

    position_m: Array
    velocity_mps: Array
    acceleration_mps2: Array


@dataclass(frozen=True)
class GuidedLimits:
    """What a vehicle can follow. GUIDED targets are not limited by the autopilot itself.

    The accelerations are those of ArduCopter's corners and of its climb at default settings.
    """

    speed_mps: float = 10.0
    climb_mps: float = 4.0
    descent_mps: float = 3.0
    acceleration_mps2: float = 5.0
    vertical_acceleration_mps2: float = 2.5


def reference(trajectory: TimedTrajectory, at_ns: NDArray[np.int64]) -> Reference:
    """State of a trajectory at instants (T,), ns since the epoch; at rest outside of it.

    Between samples up to SMOOTH_S apart it is the quintic that has the position, velocity and
    acceleration of both; between farther ones, straight.
    """
    offset_ns = trajectory.offset_ns
    at = np.asarray(at_ns, dtype=np.int64) - trajectory.start_ns
    last = len(offset_ns) - 1
    if last == 0:
        rest = np.zeros((len(at), 3))
        return Reference(np.repeat(trajectory.position_m, len(at), axis=0), rest, rest)
    low = np.clip(np.searchsorted(offset_ns, at, side="right") - 1, 0, last - 1)
    span_s = (offset_ns[low + 1] - offset_ns[low])[:, None] / 1e9
    u = np.clip((at - offset_ns[low])[:, None] / 1e9 / span_s, 0.0, 1.0)
    smooth = _quintic(trajectory, low, span_s, u)
    straight = _straight(trajectory, low, span_s, u)
    inside = ((at >= offset_ns[0]) & (at <= offset_ns[-1]))[:, None]
    curved = span_s <= SMOOTH_S
    return Reference(
        np.where(curved, smooth.position_m, straight.position_m),
        np.where(inside, np.where(curved, smooth.velocity_mps, straight.velocity_mps), 0.0),
        np.where(inside & curved, smooth.acceleration_mps2, 0.0),
    )


def check_flyable(uav: str, trajectory: TimedTrajectory, limits: GuidedLimits) -> None:
    """Raise MissionError 303 where a trajectory asks for more than a vehicle can do.

    A corner at full speed would be overshot by tens of metres, into whatever is there.
    """
    first, last = int(trajectory.offset_ns[0]), int(trajectory.offset_ns[-1])
    step = round(CHECK_STEP_S * 1e9)
    # From rest before to rest after it.
    at_ns = trajectory.start_ns + np.arange(first - step, last + 2 * step, step)
    found = reference(trajectory, at_ns)
    velocity = found.velocity_mps
    # Both the curve's own acceleration and jumps of velocity, which straight legs have.
    jump = np.diff(velocity, axis=0, append=velocity[-1:]) / CHECK_STEP_S
    asked = {
        "m/s": (np.hypot(velocity[:, 0], velocity[:, 1]), limits.speed_mps),
        "m/s of climb": (velocity[:, 2], limits.climb_mps),
        "m/s of descent": (-velocity[:, 2], limits.descent_mps),
        "m/s²": (np.hypot(jump[:, 0], jump[:, 1]), limits.acceleration_mps2),
        "m/s² upward or downward": (np.abs(jump[:, 2]), limits.vertical_acceleration_mps2),
    }
    for unit, (values, limit) in asked.items():
        worst = int(np.argmax(values))
        if values[worst] > TOLERANCE * limit:
            at_s = (int(at_ns[worst]) - trajectory.start_ns) / 1e9
            raise MissionError(
                303,
                f"{uav}: its trajectory asks for {values[worst]:.1f} {unit} at {at_s:.1f} s, the "
                f"limit is {limit:g}. Plan with smoothed trajectories, or fly the mission in AUTO.",
            )


def _quintic(
    trajectory: TimedTrajectory, low: NDArray[np.intp], span_s: Array, u: Array
) -> Reference:
    position, velocity = trajectory.position_m, trajectory.velocity_mps
    acceleration = trajectory.acceleration_mps2
    c0, c1 = position[low], velocity[low] * span_s
    c2 = 0.5 * acceleration[low] * span_s**2
    gap = position[low + 1] - c0 - c1 - c2
    speed_gap = velocity[low + 1] * span_s - c1 - 2 * c2
    bend_gap = acceleration[low + 1] * span_s**2 - 2 * c2
    c3 = 10 * gap - 4 * speed_gap + 0.5 * bend_gap
    c4 = -15 * gap + 7 * speed_gap - bend_gap
    c5 = 6 * gap - 3 * speed_gap + 0.5 * bend_gap
    return Reference(
        c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
        (c1 + u * (2 * c2 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5)))) / span_s,
        (2 * c2 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5))) / span_s**2,
    )


def _straight(
    trajectory: TimedTrajectory, low: NDArray[np.intp], span_s: Array, u: Array
) -> Reference:
    start, step = trajectory.position_m[low], np.diff(trajectory.position_m, axis=0)[low]
    return Reference(start + u * step, step / span_s, np.zeros_like(step))


# What joining may add to the trajectory's own speed and acceleration.
JOIN_MPS = 2.0
JOIN_MPS2 = 1.0
JOIN_UP_MPS = 0.7
JOIN_UP_MPS2 = 0.4
LEAST_S = 1.0
# Of a quintic from rest to rest over unit length and time: greatest speed and acceleration.
PEAK_SPEED, PEAK_ACCELERATION = 1.875, 5.7736


@dataclass(frozen=True, eq=False)
class Joining:
    """Fades a position offset out with the quintic from rest to rest, beginning at `since_s`."""

    since_s: float
    offset_m: Array
    duration_s: float

    @staticmethod
    def begin(now_s: float, offset_m: Array) -> Joining:
        """Fade out an offset (3,) as fast as the added speed and acceleration allow."""
        level, height = float(np.hypot(offset_m[0], offset_m[1])), float(abs(offset_m[2]))
        duration_s = max(
            LEAST_S,
            PEAK_SPEED * level / JOIN_MPS,
            math.sqrt(PEAK_ACCELERATION * level / JOIN_MPS2),
            PEAK_SPEED * height / JOIN_UP_MPS,
            math.sqrt(PEAK_ACCELERATION * height / JOIN_UP_MPS2),
        )
        return Joining(now_s, offset_m, duration_s)

    def applied(self, reference: Reference, now_s: float) -> Reference:
        """The reference (3,) with what is left of the offset."""
        u = min(max((now_s - self.since_s) / self.duration_s, 0.0), 1.0)
        left = 1.0 - u**3 * (10 - 15 * u + 6 * u**2)
        slope = -30 * u**2 * (1 - u) ** 2 / self.duration_s
        bend = -60 * u * (1 - u) * (1 - 2 * u) / self.duration_s**2
        return Reference(
            reference.position_m + left * self.offset_m,
            reference.velocity_mps + slope * self.offset_m,
            reference.acceleration_mps2 + bend * self.offset_m,
        )

    def over(self, now_s: float) -> bool:
        """Whether nothing of the offset is left."""
        return now_s >= self.since_s + self.duration_s
