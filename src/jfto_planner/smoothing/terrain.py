"""Height above ground along the whole curve, kept by via points, and zones by straight legs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_msgs_py.types import Array, Flags, GroundHeight
from jfto_planner.smoothing.smooth import RouteRequest, SmoothingSettings, checked, smooth_route
from jfto_planner.smoothing.trajectory import Trajectory

# Which of places (K, 3) must not be flown through.
KeepOut = Callable[[Array], Flags]

_ROUNDS = 15
_SPARE_M = 0.5


@dataclass(frozen=True)
class Clearance:
    """Least height above ground, and the spacing at which the curve is compared with it."""

    height_m: float
    spacing_m: float = 1.0

    def __post_init__(self) -> None:
        if not (self.height_m >= 0 and self.spacing_m > 0):
            raise InputError(
                f"height_m is {self.height_m} and spacing_m {self.spacing_m}; the first must not "
                "be negative, the second must be positive."
            )


@dataclass
class _Draft:
    """A route with via points: which of its points were asked for, and where the ends climb."""

    request: RouteRequest
    asked: Flags
    first: int = 0
    last: int = -1


def smooth_above(
    request: RouteRequest,
    ground_height: GroundHeight,
    clearance: Clearance,
    settings: SmoothingSettings | None = None,
    keep_out: KeepOut | None = None,
) -> Trajectory:
    """Least-time trajectory that stays `clearance` above the ground between its ends.

    An end that is lower (a pad) gets a point straight above it, where the vehicle stops: the climb
    and the landing are vertical. Between points, vias are added where the curve would be too low.
    Where it would enter what is to be kept out of, it stops at both ends of that leg, which makes
    the leg straight.

    Parameters
    ----------
    request
        Points, stops, holds and speed caps of the route.
    ground_height
        Height of the ground at (x_m, y_m), in the frame of the points.
    clearance
        Least height above it.
    settings
        How well the curve is made.
    keep_out
        Which places must not be flown through; straight legs between points do not.

    Returns
    -------
    Trajectory
        With times of the points asked for only.

    Raises
    ------
    InfeasibleError
        An inner point is itself too low, or vias do not help.
    """
    draft = _with_climbs(request, ground_height, clearance)
    spare = _SPARE_M
    for _ in range(_ROUNDS):
        trajectory = smooth_route(draft.request, settings)
        vias = _too_low(trajectory, draft, ground_height, clearance, spare)
        legs = set() if keep_out is None else _entering(trajectory, draft, keep_out, clearance)
        if not vias and not legs:
            return replace(trajectory, waypoint_s=trajectory.waypoint_s[draft.asked])
        stop = np.array(draft.request.stop)
        stop[[end for leg in legs for end in (leg, leg + 1)]] = True
        draft = replace(draft, request=replace(draft.request, stop=stop))
        draft = _with_vias(draft, vias)
        spare *= 1.5
    raise InfeasibleError(
        f"The curve is still lower than {clearance.height_m} m above ground after {_ROUNDS} rounds "
        f"of via points, first behind point {min(vias)} of the route.",
        cures=("lower the clearance", "raise the waypoints", "narrow the corridor"),
    )


def _times(trajectory: Trajectory, spacing_m: float) -> Array:
    """Instants such that the vehicle moves at most `spacing_m` between them."""
    # the control polygon is at least as long as the curve and bounds its speed
    fastest = 5.0 * np.linalg.norm(np.diff(trajectory.control_m, axis=1), axis=2).max(axis=1)
    counts = np.maximum(np.ceil(fastest / spacing_m).astype(int), 1)
    knots = trajectory.knots_s
    parts = [
        np.linspace(start, end, count, endpoint=False)
        for start, end, count in zip(knots[:-1], knots[1:], counts, strict=True)
    ]
    return np.concatenate([*parts, knots[-1:]])


def _with_climbs(request: RouteRequest, ground: GroundHeight, clearance: Clearance) -> _Draft:
    points, stop, hold, cap = checked(request)
    above = points[:, 2] - ground(points[:, 0], points[:, 1])
    low = above < clearance.height_m
    for k in np.flatnonzero(low[1:-1]) + 1:
        raise InfeasibleError(
            f"Point {k} of the route is {above[k]:.1f} m above ground, below the clearance of "
            f"{clearance.height_m} m.",
            cures=("raise the waypoint", "lower the clearance"),
        )
    full = replace(request, points_m=points, stop=stop, hold_s=hold, cap_mps=cap)
    draft = _Draft(full, np.ones(len(points), dtype=np.bool_))
    for end in (0, len(points) - 1):
        if not low[end] or len(points) == 1:
            continue
        lift = clearance.height_m - above[end] + 0.01
        via = points[end] + np.array([0.0, 0.0, lift])
        at = 1 if end == 0 else len(draft.asked) - 1
        draft = _insert(draft, at, via, stop=True)
        if end == 0:
            draft.first = 1
        else:
            draft.last = -2
    return draft


def _insert(draft: _Draft, at: int, via: Array, *, stop: bool) -> _Draft:
    old = draft.request
    request = replace(
        old,
        points_m=np.insert(old.points_m, at, via, axis=0),
        stop=np.insert(np.asarray(old.stop), at, stop),
        hold_s=np.insert(np.asarray(old.hold_s), at, 0.0),
        cap_mps=np.insert(np.asarray(old.cap_mps), at, np.inf),
    )
    return replace(draft, request=request, asked=np.insert(draft.asked, at, False))


def _too_low(
    trajectory: Trajectory, draft: _Draft, ground: GroundHeight, clearance: Clearance, spare: float
) -> dict[int, Array]:
    """For each leg that is too low, the via point that lifts it at its lowest place."""
    passed = trajectory.waypoint_s
    times = _times(trajectory, clearance.spacing_m)
    times = times[(times >= passed[draft.first]) & (times <= passed[draft.last])]
    places = trajectory.positions(times)
    bottom = ground(places[:, 0], places[:, 1]) + clearance.height_m
    missing = bottom - places[:, 2]
    legs = np.clip(np.searchsorted(passed, times, side="right") - 1, 0, len(passed) - 2)
    found = {}
    for leg in np.unique(legs[missing > 0]):
        inside = np.flatnonzero((legs == leg) & (missing > 0))
        worst = inside[np.argmax(missing[inside])]
        via = places[worst].copy()
        via[2] = bottom[worst] + spare
        found[int(leg)] = via
    return found


def _entering(
    trajectory: Trajectory, draft: _Draft, keep_out: KeepOut, clearance: Clearance
) -> set[int]:
    """Legs on which the curve enters what is to be kept out of, and is not yet straight."""
    passed, stop = trajectory.waypoint_s, np.array(draft.request.stop)
    stop[[0, -1]] = True
    times = _times(trajectory, clearance.spacing_m)
    times = times[keep_out(trajectory.positions(times))]
    legs = np.clip(np.searchsorted(passed, times, side="right") - 1, 0, len(passed) - 2)
    return {int(leg) for leg in np.unique(legs) if not (stop[leg] and stop[leg + 1])}


def _with_vias(draft: _Draft, vias: dict[int, Array]) -> _Draft:
    for leg in sorted(vias, reverse=True):
        draft = _insert(draft, leg + 1, vias[leg], stop=False)
    return draft
