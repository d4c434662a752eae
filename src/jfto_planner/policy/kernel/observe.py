"""What a rollout's next choice is based on: who chooses, and what is allowed.

Each function works on rollout p of problem b and fills step t of a View. The tensor twin is
environment.py, which works on any device; a test holds the two to the same answers.
"""

from __future__ import annotations

import math

import numpy as np

from jfto_planner.policy.features import CHECKED_FRACTIONS
from jfto_planner.policy.kernel.arrays import Array, Fleet, Scene, View
from jfto_planner.policy.kernel.describe import describe_pairs, describe_state, norm
from jfto_world.compiled import inner

HALF, WHOLE = CHECKED_FRACTIONS


@inner
def _reach(scene: Scene, b: int, i: int, j: int) -> float:
    return min(scene.reach[b, i], scene.reach[b, j])


@inner
def _share_flown(fleet: Fleet, b: int, p: int, uav: int, time: float) -> float:
    span = max(fleet.arrive[b, p, uav] - fleet.depart[b, p, uav], 1e-9)
    return min(max((time - fleet.depart[b, p, uav]) / span, 0.0), 1.0)


@inner
def leg_time(scene: Scene, b: int, uav: int, dx: float, dy: float, dz: float) -> float:
    """Time of a direct leg, as in ConstantSpeed."""
    level = math.sqrt(dx * dx + dy * dy) / scene.speed[b, uav]
    steep = dz / scene.climb[b, uav] if dz > 0 else -dz / scene.descent[b, uav]
    return max(level, steep)


@inner
def first_free(scene: Scene, fleet: Fleet, b: int, p: int) -> tuple[int, float, float]:
    """The UAV that is free first, when, and when the next one is (inf: none flies)."""
    active, now, other = 0, np.inf, np.inf
    for a in range(scene.speed.shape[1]):
        clock = np.inf if fleet.done[b, p, a] else fleet.arrive[b, p, a]
        if clock < now:
            active, now, other = a, clock, now
        elif clock < other:
            other = clock
    if now == np.inf:
        now = 0.0
    return active, now, other


@inner
def _links_without(scene: Scene, b: int, active: int, places: Array, degree: Array) -> None:
    """Degrees (A,) at given places (A, 3) with the active UAV out of reach."""
    degree[:] = 0
    for i in range(len(places)):
        for j in range(i):
            if active not in (i, j):
                gap = norm(
                    places[i, 0] - places[j, 0],
                    places[i, 1] - places[j, 1],
                    places[i, 2] - places[j, 2],
                )
                if gap <= _reach(scene, b, i, j):
                    degree[i] += 1
                    degree[j] += 1


@inner
def _links_at(
    scene: Scene, b: int, active: int, places: Array, degree: Array, x: float, y: float, z: float
) -> tuple[int, bool]:
    """Degree of the active UAV at a point, and whether all have their K_min neighbours then."""
    own, enough = 0, True
    for a in range(len(places)):
        if a != active:
            gap = norm(x - places[a, 0], y - places[a, 1], z - places[a, 2])
            linked = gap <= _reach(scene, b, active, a)
            own += linked
            if scene.uav_valid[b, a] and degree[a] + linked < scene.k_min[b]:
                enough = False
    if scene.uav_valid[b, active] and own < scene.k_min[b]:
        enough = False
    return own, enough


@inner
def check_rule(
    scene: Scene,
    fleet: Fleet,
    b: int,
    p: int,
    t: int,
    other: float,
    view: View,
    places: Array,
    degree: Array,
) -> None:
    """Fill keeps_rule and the degrees (A,) of everyone if the active UAV stays.

    `places` (A, 3) and `degree` (A,) are room to work in.
    """
    uavs, waypoints = scene.speed.shape[1], scene.waypoints.shape[1]
    active, now = view.active[b, p, t], view.now[b, p, t]
    alone = other == np.inf
    window = 0.0 if alone else max(other - now, 0.0)
    keeps = view.keeps_rule[b, p, t]
    keeps[:] = True
    here = fleet.target[b, p, active]
    for half in range(2):
        fraction = HALF if half == 0 else WHOLE
        for a in range(uavs):
            share = _share_flown(fleet, b, p, a, now + fraction * window)
            for axis in range(3):
                low = fleet.origin[b, p, a, axis]
                places[a, axis] = low + (fleet.target[b, p, a, axis] - low) * share
        _links_without(scene, b, active, places, degree)
        for j in range(waypoints):
            if not fleet.visited[b, p, j]:
                duration = view.duration[b, p, t, j]
                flown = duration if alone else min(window, duration)
                share = fraction * flown / max(duration, 1e-9)
                x = here[0] + (scene.waypoints[b, j, 0] - here[0]) * share
                y = here[1] + (scene.waypoints[b, j, 1] - here[1]) * share
                z = here[2] + (scene.waypoints[b, j, 2] - here[2]) * share
                keeps[j] &= _links_at(scene, b, active, places, degree, x, y, z)[1]
        own, enough = _links_at(scene, b, active, places, degree, here[0], here[1], here[2])
        keeps[waypoints] &= enough
    for a in range(uavs):
        if a != active:
            gap = norm(here[0] - places[a, 0], here[1] - places[a, 1], here[2] - places[a, 2])
            degree[a] += gap <= _reach(scene, b, active, a)
    degree[active] = own


@inner
def check_allowed(
    scene: Scene, fleet: Fleet, b: int, p: int, t: int, other: float, view: View
) -> None:
    """Fill allowed; where every choice breaks a rule, the mildest are left."""
    waypoints = scene.waypoints.shape[1]
    active, now = view.active[b, p, t], view.now[b, p, t]
    keeps, allowed = view.keeps_rule[b, p, t], view.allowed[b, p, t]
    any_free, any_fair, any_good = False, False, False
    for j in range(waypoints):
        free = not fleet.visited[b, p, j]
        any_free |= free
        fair = free and now + view.duration[b, p, t, j] <= scene.t_max[b, active]
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
            allowed[j] = not fleet.visited[b, p, j]


@inner
def observe_one(
    scene: Scene, fleet: Fleet, b: int, p: int, t: int, view: View, scratch: Array, degree: Array
) -> None:
    """Fill step t of the view with what the UAV that is free first may choose."""
    active, now, other = first_free(scene, fleet, b, p)
    view.active[b, p, t], view.now[b, p, t] = active, now
    here = fleet.target[b, p, active]
    for j in range(scene.waypoints.shape[1]):
        view.visited[b, p, t, j] = fleet.visited[b, p, j]
        if not fleet.visited[b, p, j]:
            view.duration[b, p, t, j] = leg_time(
                scene,
                b,
                active,
                scene.waypoints[b, j, 0] - here[0],
                scene.waypoints[b, j, 1] - here[1],
                scene.waypoints[b, j, 2] - here[2],
            )
    for a in range(scene.speed.shape[1]):
        view.node[b, p, t, a] = fleet.node[b, p, a]
    check_rule(scene, fleet, b, p, t, other, view, scratch, degree)
    check_allowed(scene, fleet, b, p, t, other, view)
    describe_state(scene, fleet, b, p, t, other, view, degree)
    describe_pairs(scene, fleet, b, p, t, view)


@inner
def step_one(scene: Scene, fleet: Fleet, b: int, p: int, t: int, view: View, choice: int) -> None:
    """Carry out one choice: a waypoint, or W to stop."""
    waypoints = scene.waypoints.shape[1]
    active, now = view.active[b, p, t], view.now[b, p, t]
    if fleet.done[b, p, active]:
        return
    if not view.keeps_rule[b, p, t, choice]:
        fleet.misses[b, p] += 1
    fleet.depart[b, p, active] = now
    fleet.arrive[b, p, active] = now
    for axis in range(3):
        fleet.origin[b, p, active, axis] = fleet.target[b, p, active, axis]
    if choice == waypoints:
        fleet.done[b, p, active] = True
        return
    arrival = now + view.duration[b, p, t, choice]
    limit = scene.t_max[b, active]
    square = 0.0
    for axis in range(3):
        step = scene.waypoints[b, choice, axis] - fleet.target[b, p, active, axis]
        square += step * step
        fleet.target[b, p, active, axis] = scene.waypoints[b, choice, axis]
    fleet.arrive[b, p, active] = arrival
    fleet.length[b, p] += math.sqrt(square)
    fleet.late[b, p] += max(arrival - limit, 0.0) - max(now - limit, 0.0)
    fleet.visited[b, p, choice] = True
    fleet.node[b, p, active] = scene.starts + choice
