"""When and how closely each waypoint was passed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from jfto.analysis.motion import motions
from jfto.analysis.record import RecordedFlight, Track
from jfto_msgs_py.records.passage import VISITED_M, Passage
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array

# Around its planned time, later by what its forerunner was late, a waypoint is looked for first.
_WINDOW_S = 20.0
# Being this little further away than at the closest counts as being there.
_THERE_M = 0.5
# Who is there for longer does not fly by.
_FLY_BY_S = 3.0


def passages_of(flight: RecordedFlight, plan: Plan) -> tuple[Passage, ...]:
    """Every waypoint to be visited, UAV by UAV in the order of the routes.

    Those that are only passed tell when the next is to be looked for.
    """
    photos = {waypoint.id for waypoint in plan.waypoints if waypoint.photo}
    where = {waypoint.id: np.array(waypoint.position_m) for waypoint in plan.waypoints}
    found = []
    for uav, route, motion in zip(plan.uavs, plan.routes, motions(plan), strict=True):
        track = flight.tracks[uav.id]
        planned = Track(motion.times_s, motion.position_m)
        late_s, after_s = 0.0, 0.0
        for number, planned_s in zip(route.waypoint_ids, route.arrival_s, strict=True):
            one = _passage(track, planned, where[number], planned_s, late_s, after_s)
            reached_s, closest_m = one
            if number in photos:
                found.append(Passage(uav.id, number, planned_s, reached_s, closest_m))
            if reached_s is not None and closest_m <= VISITED_M:
                late_s, after_s = reached_s - planned_s, reached_s
    return tuple(found)


@dataclass(frozen=True)
class UavTiming:
    """How one UAV kept to its waypoints: `visited` of `count`, timing errors in s over those that
    were visited, late is positive, and distances in m over all; None where there are none.
    """

    uav: str
    visited: int
    count: int
    mean_late_s: float | None
    worst_late_s: float | None
    median_m: float | None
    worst_m: float | None


def timing_of(uav: str, passages: Sequence[Passage]) -> UavTiming:
    """The UAV's timing, out of the whole fleet's passages."""
    mine = [one for one in passages if one.uav == uav]
    late = [one.late_s for one in mine if one.visited and one.late_s is not None]
    closest = [one.closest_m for one in mine]
    return UavTiming(
        uav=uav,
        visited=sum(one.visited for one in mine),
        count=len(mine),
        mean_late_s=float(np.mean(late)) if late else None,
        worst_late_s=max(late, key=abs, default=None),
        median_m=float(np.median(closest)) if closest else None,
        worst_m=max(closest, default=None),
    )


def finished_s(passages: tuple[Passage, ...]) -> Mapping[str, float]:
    """When each UAV passed its last waypoint that it did pass."""
    found: dict[str, float] = {}
    for one in passages:
        if one.visited and one.reached_s is not None:
            found[one.uav] = max(found.get(one.uav, 0.0), one.reached_s)
    return found


@dataclass(frozen=True)
class _Approach:
    """`came_s` is when a UAV came near, `closest_s` when it was at its closest soon after.

    `stays` says that it did not fly by.
    """

    came_s: float
    closest_s: float
    least_m: float
    stays: bool


def _passage(
    track: Track, planned: Track, target_m: Array, planned_s: float, late_s: float, after_s: float
) -> tuple[float | None, float]:
    """Time and distance of the passage, looked for where it is expected, else anywhere later."""
    expected_s = planned_s + late_s
    found = None
    for low_s, high_s in ((expected_s - _WINDOW_S, expected_s + _WINDOW_S), (after_s, np.inf)):
        found = _approach(track, target_m, max(low_s, after_s), high_s)
        if found is not None and found.least_m <= VISITED_M:
            break
    if found is None:
        return None, float("inf")
    # An arrival is planned for when the vehicle has settled, which is after it came: the planned
    # flight is held to the same moment as the one flown.
    low_s, high_s = planned_s - _WINDOW_S, planned_s + _FLY_BY_S
    due = _approach(planned, target_m, low_s, high_s, found.least_m)
    if due is None:
        return found.closest_s, found.least_m
    late = found.closest_s - due.closest_s
    if found.stays and due.stays:
        late = found.came_s - due.came_s
    return planned_s + late, found.least_m


def _approach(
    track: Track, target_m: Array, low_s: float, high_s: float, within_m: float = 0.0
) -> _Approach | None:
    """The approach within a stretch of time, None where nothing is known of it.

    Who stays comes when it is first no further away than the least distance, or `within_m`, and
    a little.
    """
    first = max(int(np.searchsorted(track.times_s, low_s, side="right")) - 1, 0)
    last = int(np.searchsorted(track.times_s, high_s, side="left")) + 1
    times, places = track.times_s[first:last], track.position_m[first:last]
    if len(times) < 2:
        return None
    begin, step = places[:-1], np.diff(places, axis=0)
    length_2 = np.einsum("ij,ij->i", step, step)
    along = np.einsum("ij,ij->i", target_m - begin, step)
    share = np.clip(np.divide(along, length_2, out=np.zeros_like(along), where=length_2 > 0), 0, 1)
    away = np.linalg.norm(begin + share[:, None] * step - target_m, axis=1)
    least = float(away.min())
    near_m = max(least, within_m) + _THERE_M
    arrived = int(np.argmax(away <= near_m))
    later = max(int(np.searchsorted(times, times[arrived] + _FLY_BY_S)), arrived + 1)
    closest = arrived + int(np.argmin(away[arrived:later]))
    when = times[:-1] + share * np.diff(times)
    stays = bool((away[arrived:later] <= near_m).all())
    return _Approach(float(when[arrived]), float(when[closest]), least, stays)
