"""What a rollout's next choice is based on: who chooses, and what is allowed.

Each function works on rollout p of problem b and fills step t of what is seen. The tensor twin is
network/environment.py, which works on any device; a test holds the two to the same answers.
"""

from __future__ import annotations

import math

import numpy as np

from jfto_planner.policy.features import CHECKED_FRACTIONS, LEAST_LENGTH
from jfto_planner.policy.kernel.describe import describe_pairs, describe_state, norm
from jfto_planner.policy.kernel.episode import Episode
from jfto_world.compiled import inner

HALF, WHOLE = CHECKED_FRACTIONS


@inner
def _reach(episode: Episode, b: int, i: int, j: int) -> float:
    problems = episode.problems
    return min(problems.reach[b, i], problems.reach[b, j])


@inner
def _share_flown(episode: Episode, b: int, p: int, uav: int, time: float) -> float:
    span = max(episode.arrive[b, p, uav] - episode.depart[b, p, uav], LEAST_LENGTH)
    return min(max((time - episode.depart[b, p, uav]) / span, 0.0), 1.0)


@inner
def leg_time(episode: Episode, b: int, uav: int, dx: float, dy: float, dz: float) -> float:
    """Time of a direct leg, as in ConstantSpeed."""
    problems = episode.problems
    level = math.sqrt(dx * dx + dy * dy) / problems.speed[b, uav]
    steep = dz / problems.climb[b, uav] if dz > 0 else -dz / problems.descent[b, uav]
    return max(level, steep)


@inner
def first_free(episode: Episode, b: int, p: int) -> tuple[int, float, float]:
    """The UAV that is free first, when, and when the next one is (inf: none flies)."""
    problems = episode.problems
    active, now, other = 0, np.inf, np.inf
    for a in range(problems.speed.shape[1]):
        clock = np.inf if episode.done[b, p, a] else episode.arrive[b, p, a]
        if clock < now:
            active, now, other = a, clock, now
        elif clock < other:
            other = clock
    if now == np.inf:
        now = 0.0
    return active, now, other


@inner
def _links_without(episode: Episode, b: int, active: int) -> None:
    """Degrees (A,) at given places (A, 3) with the active UAV out of reach."""
    places, degree = episode.places, episode.degree
    degree[:] = 0
    for i in range(len(places)):
        for j in range(i):
            if active not in (i, j):
                gap = norm(
                    places[i, 0] - places[j, 0],
                    places[i, 1] - places[j, 1],
                    places[i, 2] - places[j, 2],
                )
                if gap <= _reach(episode, b, i, j):
                    degree[i] += 1
                    degree[j] += 1


@inner
def _links_at(
    episode: Episode, b: int, active: int, x: float, y: float, z: float
) -> tuple[int, bool]:
    """Degree of the active UAV at a point, and whether all have their K_min neighbours then."""
    problems = episode.problems
    places, degree = episode.places, episode.degree
    own, enough = 0, True
    for a in range(len(places)):
        if a != active:
            gap = norm(x - places[a, 0], y - places[a, 1], z - places[a, 2])
            linked = gap <= _reach(episode, b, active, a)
            own += linked
            if problems.uav_valid[b, a] and degree[a] + linked < problems.k_min[b]:
                enough = False
    if problems.uav_valid[b, active] and own < problems.k_min[b]:
        enough = False
    return own, enough


@inner
def check_rule(episode: Episode, b: int, p: int, t: int, other: float) -> None:
    """Fill keeps_rule and the degrees (A,) of everyone if the active UAV stays.

    `places` (A, 3) and `degree` (A,) are room to work in.
    """
    problems, seen = episode.problems, episode.seen
    places, degree = episode.places, episode.degree
    uavs, waypoints = problems.speed.shape[1], problems.waypoints.shape[1]
    active, now = seen.active[b, p, t], seen.now[b, p, t]
    alone = other == np.inf
    window = 0.0 if alone else max(other - now, 0.0)
    keeps = seen.keeps_rule[b, p, t]
    keeps[:] = True
    here = episode.target[b, p, active]
    for half in range(2):
        fraction = HALF if half == 0 else WHOLE
        for a in range(uavs):
            share = _share_flown(episode, b, p, a, now + fraction * window)
            for axis in range(3):
                low = episode.origin[b, p, a, axis]
                places[a, axis] = low + (episode.target[b, p, a, axis] - low) * share
        _links_without(episode, b, active)
        for j in range(waypoints):
            if not episode.visited[b, p, j]:
                duration = seen.duration[b, p, t, j]
                flown = duration if alone else min(window, duration)
                share = fraction * flown / max(duration, LEAST_LENGTH)
                x = here[0] + (problems.waypoints[b, j, 0] - here[0]) * share
                y = here[1] + (problems.waypoints[b, j, 1] - here[1]) * share
                z = here[2] + (problems.waypoints[b, j, 2] - here[2]) * share
                keeps[j] &= _links_at(episode, b, active, x, y, z)[1]
        x, y, z = np.float64(here[0]), np.float64(here[1]), np.float64(here[2])
        own, enough = _links_at(episode, b, active, x, y, z)
        keeps[waypoints] &= enough
    for a in range(uavs):
        if a != active:
            gap = norm(here[0] - places[a, 0], here[1] - places[a, 1], here[2] - places[a, 2])
            degree[a] += gap <= _reach(episode, b, active, a)
    degree[active] = own


@inner
def check_allowed(episode: Episode, b: int, p: int, t: int, other: float) -> None:
    """Fill allowed; where every choice breaks a rule, the mildest are left."""
    problems, seen = episode.problems, episode.seen
    waypoints = problems.waypoints.shape[1]
    active, now = seen.active[b, p, t], seen.now[b, p, t]
    keeps, allowed = seen.keeps_rule[b, p, t], seen.allowed[b, p, t]
    any_free, any_fair, any_good = False, False, False
    for j in range(waypoints):
        free = not episode.visited[b, p, j]
        any_free |= free
        fair = free and now + seen.duration[b, p, t, j] <= problems.t_max[b, active]
        any_fair |= fair
        any_good |= fair and keeps[j]
        allowed[j] = fair
    may_stop = other != np.inf or not any_free
    allowed[waypoints] = may_stop
    any_fair |= may_stop
    any_good |= may_stop and keeps[waypoints]
    for j in range(waypoints + 1):
        if any_good:
            allowed[j] &= keeps[j]
        elif not any_fair and j < waypoints:
            allowed[j] = not episode.visited[b, p, j]


@inner
def observe_one(episode: Episode, b: int, p: int, t: int) -> None:
    """Fill step t of what is seen with what the UAV that is free first may choose."""
    problems, seen = episode.problems, episode.seen
    active, now, other = first_free(episode, b, p)
    seen.active[b, p, t], seen.now[b, p, t] = active, now
    here = episode.target[b, p, active]
    for j in range(problems.waypoints.shape[1]):
        seen.visited[b, p, t, j] = episode.visited[b, p, j]
        if not episode.visited[b, p, j]:
            seen.duration[b, p, t, j] = leg_time(
                episode,
                b,
                active,
                problems.waypoints[b, j, 0] - here[0],
                problems.waypoints[b, j, 1] - here[1],
                problems.waypoints[b, j, 2] - here[2],
            )
    for a in range(problems.speed.shape[1]):
        seen.node[b, p, t, a] = episode.node[b, p, a]
    check_rule(episode, b, p, t, other)
    check_allowed(episode, b, p, t, other)
    describe_state(episode, b, p, t, other)
    describe_pairs(episode, b, p, t)


@inner
def step_one(episode: Episode, b: int, p: int, t: int, choice: int) -> None:
    """Carry out one choice: a waypoint, or W to stop."""
    problems, seen = episode.problems, episode.seen
    waypoints = problems.waypoints.shape[1]
    active, now = seen.active[b, p, t], seen.now[b, p, t]
    if episode.done[b, p, active]:
        return
    if not seen.keeps_rule[b, p, t, choice]:
        episode.misses[b, p] += 1
    episode.depart[b, p, active] = now
    episode.arrive[b, p, active] = now
    for axis in range(3):
        episode.origin[b, p, active, axis] = episode.target[b, p, active, axis]
    if choice == waypoints:
        episode.done[b, p, active] = True
        return
    arrival = now + seen.duration[b, p, t, choice]
    limit = problems.t_max[b, active]
    square = 0.0
    for axis in range(3):
        step = problems.waypoints[b, choice, axis] - episode.target[b, p, active, axis]
        square += step * step
        episode.target[b, p, active, axis] = problems.waypoints[b, choice, axis]
    episode.arrive[b, p, active] = arrival
    episode.length[b, p] += math.sqrt(square)
    episode.late[b, p] += max(arrival - limit, 0.0) - max(now - limit, 0.0)
    episode.visited[b, p, choice] = True
    episode.node[b, p, active] = problems.starts.shape[1] + choice
