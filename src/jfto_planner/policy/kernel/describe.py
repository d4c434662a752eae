"""Features of a choice, compiled; the tensor twin is network/describe.py."""

from __future__ import annotations

import math

import numpy as np

from jfto_planner.policy.features import (
    ALONE,
    AWAY,
    AWAY_SCALE,
    CLOSE,
    CLOSE_SCALE,
    DEGREE_MOST,
    FLYING,
    LEAD,
    LEAD_MOST,
    LEAST_DEGREE,
    LEAST_LENGTH,
    LEAST_TIME,
    LEFT,
    LOG_AWAY,
    LOG_EXCESS,
    LOG_EXCESS_NEXT,
    LOG_NEXT,
    LOG_RIVAL,
    LOG_SECOND,
    NEAR_OTHERS,
    NEAREST,
    NO_DEGREE,
    NO_RIVAL,
    OWN_DEGREE,
    OWN_GROUND,
    SLACK,
    SOONER,
    SOONER_MOST,
    TIME_LEFT,
    TIME_USED,
    TOUR,
    TURN,
    WINDOW,
    WORK,
    WORK_MOST,
)
from jfto_planner.policy.kernel.episode import Episode
from jfto_world.compiled import inner


@inner
def norm(x: float, y: float, z: float) -> float:
    """Length of a vector."""
    return math.sqrt(x * x + y * y + z * z)


@inner
def _rivals(
    episode: Episode, b: int, p: int, active: int, now: float, point: tuple[float, float, float]
) -> tuple[float, float]:
    """Distance of the nearest other UAV in flight to a point, and the least time until one of them
    could be there.
    """
    problems = episode.problems
    rival, soonest = NO_RIVAL, NO_RIVAL
    for a in range(problems.speed.shape[1]):
        if a != active and not episode.done[b, p, a]:
            target = episode.target[b, p, a]
            gap = norm(point[0] - target[0], point[1] - target[1], point[2] - target[2])
            rival = min(rival, gap)
            wait = max(episode.arrive[b, p, a] - now, 0.0) + gap / problems.speed[b, a]
            soonest = min(soonest, wait)
    return rival, soonest


@inner
def _others(episode: Episode, b: int, p: int, j: int, unit: float) -> tuple[float, float, int]:
    """Distances from a waypoint to its nearest and second nearest unvisited other, and how many
    are close.
    """
    first, second, close = NO_RIVAL, NO_RIVAL, 0
    for rank in range(episode.nearest.shape[2]):
        k = episode.nearest[b, j, rank]
        gap = episode.distance[b, j, k]
        if gap * unit > CLOSE and second < NO_RIVAL:
            break
        if k == j or episode.visited[b, p, k]:
            continue
        close += gap * unit <= CLOSE
        if first == NO_RIVAL:
            first = min(gap, NO_RIVAL)
        elif second == NO_RIVAL:
            second = min(gap, NO_RIVAL)
    return first, second, close


@inner
def _relate_to_nearest(
    episode: Episode, b: int, p: int, t: int, least: float, least_ahead: float, unit: float
) -> None:
    """Turn the distances left in two columns into logarithms of their excess of the least."""
    seen = episode.seen
    for j in range(seen.pair.shape[3]):
        if not episode.visited[b, p, j]:
            pair = seen.pair[b, p, t, j]
            pair[LOG_EXCESS] = math.log1p((pair[LOG_EXCESS] - least) * unit)
            pair[LOG_EXCESS_NEXT] = math.log1p((pair[LOG_EXCESS_NEXT] - least_ahead) * unit)


@inner
def describe_pairs(episode: Episode, b: int, p: int, t: int) -> None:
    """Fill what relates the active UAV to each unvisited waypoint, and the state drawn from it."""
    problems, seen = episode.problems, episode.seen
    waypoints = problems.waypoints.shape[1]
    active, now = seen.active[b, p, t], seen.now[b, p, t]
    total = 0
    for j in range(waypoints):
        total += problems.waypoint_valid[b, j]
    unit = math.sqrt(total)
    here, back = episode.target[b, p, active], episode.origin[b, p, active]
    hx, hy, hz = here[0] - back[0], here[1] - back[1], here[2] - back[2]
    heading = norm(hx, hy, hz)
    least, least_ahead, least_lead, own_ground, left = np.inf, np.inf, np.inf, 0, 0
    for j in range(waypoints):
        if episode.visited[b, p, j]:
            continue
        left += 1
        pair = seen.pair[b, p, t, j]
        x, y, z = (
            problems.waypoints[b, j, 0],
            problems.waypoints[b, j, 1],
            problems.waypoints[b, j, 2],
        )
        dx, dy, dz = x - here[0], y - here[1], z - here[2]
        away = norm(dx, dy, dz)
        rival, soonest = _rivals(episode, b, p, active, now, (x, y, z))
        first, second, close = _others(episode, b, p, j, unit)
        duration = seen.duration[b, p, t, j]
        turn = (hx * dx + hy * dy + hz * dz) / max(heading * away, LEAST_LENGTH)
        pair[LOG_AWAY] = math.log1p(away * unit)
        pair[LOG_RIVAL] = math.log1p(rival * unit)
        pair[AWAY] = away * unit / AWAY_SCALE
        pair[SLACK] = (problems.t_max[b, active] - now - duration) / problems.t_max[b, active]
        pair[LOG_NEXT] = math.log1p(first * unit)
        pair[LOG_SECOND] = math.log1p(second * unit)
        pair[LOG_EXCESS] = away
        pair[SOONER] = min(max(soonest - duration, -SOONER_MOST), SOONER_MOST) * unit / AWAY_SCALE
        pair[TURN] = turn
        pair[NEAR_OTHERS] = close / CLOSE_SCALE
        pair[LOG_EXCESS_NEXT] = away + first
        least = min(least, away)
        least_ahead = min(least_ahead, away + first)
        least_lead = min(least_lead, away - rival)
        own_ground += away < rival
    _relate_to_nearest(episode, b, p, t, least, least_ahead, unit)
    state = seen.state[b, p, t]
    if left > 0:
        state[NEAREST] = math.log1p(least * unit)
        state[LEAD] = min(max(least_lead * unit, -LEAD_MOST), LEAD_MOST) / AWAY_SCALE
        state[OWN_GROUND] = own_ground / left


@inner
def describe_state(episode: Episode, b: int, p: int, t: int, other: float) -> None:
    """Fill T and K of the active UAV and of the fleet."""
    problems, seen = episode.problems, episode.seen
    degree = episode.degree
    uavs, waypoints = problems.speed.shape[1], problems.waypoints.shape[1]
    active, now = seen.active[b, p, t], seen.now[b, p, t]
    left, total = 0, 0
    for j in range(waypoints):
        left += not episode.visited[b, p, j]
        total += problems.waypoint_valid[b, j]
    flying, fleet_size, capacity, least = 0, 0, 0.0, NO_DEGREE
    for a in range(uavs):
        flying += not episode.done[b, p, a]
        fleet_size += problems.uav_valid[b, a]
        if not episode.done[b, p, a]:
            capacity += max(problems.t_max[b, a] - episode.arrive[b, p, a], 0.0)
        if problems.uav_valid[b, a]:
            least = min(least, degree[a])
    need = max(problems.k_min[b], 1)
    work = TOUR * left / math.sqrt(total)
    state = seen.state[b, p, t]
    state[TIME_USED] = now / problems.t_max[b, active]
    state[TIME_LEFT] = problems.t_max[b, active] - now
    state[WINDOW] = 0.0 if other == np.inf else other - now
    state[LEFT] = left / total
    state[FLYING] = flying / fleet_size
    state[WORK] = min(work / max(capacity, LEAST_TIME), WORK_MOST)
    state[OWN_DEGREE] = min(degree[active] / need, DEGREE_MOST)
    state[LEAST_DEGREE] = min(least / need, DEGREE_MOST)
    state[ALONE] = 1.0 if other == np.inf else 0.0
