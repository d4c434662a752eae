"""Distance between vehicles in continuous time, kept by start delays and slower flight."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_msgs_py.types import Array
from jfto_planner.smoothing.trajectory import Trajectory

NeighbourCheck = Callable[[Array], bool]

# Steps in which delays and factors are tried, and at which distances are looked at first.
_DELAY_STEP_S, _SLOW_STEP, _CHECK_S = 0.5, 0.05, 0.1


@dataclass(frozen=True)
class SeparationSettings:
    """How much may be changed to keep vehicles apart: start delays, and slower flight."""

    delay_max_s: float = 30.0
    slow_max: float = 1.2

    def __post_init__(self) -> None:
        if self.delay_max_s < 0 or self.slow_max < 1:
            raise InputError(
                f"delay_max_s is {self.delay_max_s}, must not be negative, and slow_max is "
                f"{self.slow_max}, must be at least 1."
            )


def separate(
    trajectories: tuple[Trajectory, ...],
    d_min_m: float,
    settings: SeparationSettings | None = None,
    neighbours_kept: NeighbourCheck | None = None,
) -> tuple[Trajectory, ...]:
    """Delay or slow vehicles, later ones first, until all are at least `d_min_m` apart.

    Among changes that do, the one that ends a vehicle's flight soonest is taken.

    Parameters
    ----------
    trajectories
        Trajectories of the fleet, one per UAV.
    d_min_m
        Least distance between two vehicles, m.
    settings
        How much may be changed.
    neighbours_kept
        Gets the positions (K, A, 3) of all vehicles once per second and says whether a change is
        acceptable; one that it refuses is not made.

    Returns
    -------
    tuple of Trajectory
        In the same order.

    Raises
    ------
    InfeasibleError
        Names the pair and the time that cannot be kept apart.
    """
    settings = settings or SeparationSettings()
    flown = list(trajectories)
    for vehicle in range(1, len(flown)):
        conflict = _conflict(flown[:vehicle], flown[vehicle], d_min_m)
        if conflict is None:
            continue
        for option in _options(flown[vehicle], settings):
            if _conflict(flown[:vehicle], option, d_min_m) is not None:
                continue
            trial = [*flown[:vehicle], option, *flown[vehicle + 1 :]]
            if neighbours_kept is None or neighbours_kept(_together(trial)):
                flown[vehicle] = option
                break
        else:
            other, time_s, distance_m = conflict
            raise InfeasibleError(
                f"UAVs {other} and {vehicle} come within "
                f"{distance_m:.1f} m at {time_s:.1f} s, d_min is {d_min_m} m; no "
                f"start delay up to {settings.delay_max_s} s or slower flight keeps them apart.",
                cures=("allow longer delays", "plan other routes", "lower d_min_m"),
            )
    return tuple(flown)


def _options(trajectory: Trajectory, settings: SeparationSettings) -> list[Trajectory]:
    delays = np.arange(0, settings.delay_max_s + 1e-9, _DELAY_STEP_S)
    factors = np.arange(1.0, settings.slow_max + 1e-9, _SLOW_STEP)
    pairs = [(float(d), float(f)) for d in delays for f in factors if d > 0 or f > 1]
    span = trajectory.end_s - trajectory.delay_s
    pairs.sort(key=lambda pair: (pair[0] + span * pair[1], pair[0]))
    return [trajectory.delayed(delay).slowed(factor) for delay, factor in pairs]


def _conflict(
    earlier: list[Trajectory], option: Trajectory, d_min_m: float
) -> tuple[int, float, float] | None:
    """The first earlier vehicle that `option` would come too close to; when, and how close."""
    for other, flown in enumerate(earlier):
        time_s, distance_m = closest(flown, option, _CHECK_S, d_min_m)
        if distance_m < d_min_m:
            return other, time_s, distance_m
    return None


def closest(
    one: Trajectory, two: Trajectory, check_s: float = _CHECK_S, enough_m: float = np.inf
) -> tuple[float, float]:
    """Time and distance of the closest approach; no finer than to tell it from `enough_m`.

    Otherwise exact to about a millimetre: intervals that could hide a closer approach, judged by
    the speeds of the two, are sampled again 64 times finer, twice.
    """
    end = max(one.end_s, two.end_s)
    step = check_s
    times = np.append(np.arange(0.0, end, step), end)
    best_time, best = 0.0, np.inf
    for level in range(3):
        gap = np.linalg.norm(one.positions(times) - two.positions(times), axis=1)
        lowest = int(np.argmin(gap))
        if gap[lowest] < best:
            best_time, best = float(times[lowest]), float(gap[lowest])
        if level == 2 or (best < enough_m < np.inf):
            break
        reach = (_top_speed(one) + _top_speed(two)) * 0.5 * step
        near = times[gap - reach < min(best, enough_m)]
        if len(near) == 0:
            break
        offsets = np.linspace(-0.5 * step, 0.5 * step, 65)
        times = np.unique(np.clip(near[:, None] + offsets, 0.0, end))
        step /= 64.0
    return best_time, best


def _top_speed(trajectory: Trajectory) -> float:
    legs = np.linalg.norm(np.diff(trajectory.control_m, axis=1), axis=2)
    return float(np.max(5.0 * legs / trajectory.duration_s[:, None]))


def _together(trajectories: list[Trajectory]) -> Array:
    end = max(t.end_s for t in trajectories)
    times = np.append(np.arange(0.0, end, 1.0), end)
    return np.stack([t.positions(times) for t in trajectories], axis=1)
