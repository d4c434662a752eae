"""Features of a choice, compiled; the tensor twin is policy/describe.py."""

from __future__ import annotations

import math

import numpy as np

from jfto_planner.policy.features import CLOSE, NO_RIVAL
from jfto_planner.policy.kernel.arrays import Array, Fleet, Scene, View
from jfto_world.compiled import inner


@inner
def norm(x: float, y: float, z: float) -> float:
    """Length of a vector."""
    return math.sqrt(x * x + y * y + z * z)


@inner
def _rivals(
    scene: Scene,
    fleet: Fleet,
    b: int,
    p: int,
    active: int,
    now: float,
    x: float,
    y: float,
    z: float,
) -> tuple[float, float]:
    """Distance of the nearest other UAV in flight to a point, and the least time until one of them
    could be there.
    """
    rival, soonest = NO_RIVAL, NO_RIVAL
    for a in range(scene.speed.shape[1]):
        if a != active and not fleet.done[b, p, a]:
            target = fleet.target[b, p, a]
            gap = norm(x - target[0], y - target[1], z - target[2])
            rival = min(rival, gap)
            wait = max(fleet.arrive[b, p, a] - now, 0.0) + gap / scene.speed[b, a]
            soonest = min(soonest, wait)
    return rival, soonest


@inner
def _others(
    scene: Scene, fleet: Fleet, b: int, p: int, j: int, unit: float
) -> tuple[float, float, int]:
    """Distances from a waypoint to its nearest and second nearest unvisited other, and how many
    are close.
    """
    first, second, close = NO_RIVAL, NO_RIVAL, 0
    for rank in range(scene.nearest.shape[2]):
        k = scene.nearest[b, j, rank]
        gap = scene.distance[b, j, k]
        if gap * unit > CLOSE and second < NO_RIVAL:
            break
        if k == j or fleet.visited[b, p, k]:
            continue
        close += gap * unit <= CLOSE
        if first == NO_RIVAL:
            first = min(gap, NO_RIVAL)
        elif second == NO_RIVAL:
            second = min(gap, NO_RIVAL)
    return first, second, close


@inner
def _relate_to_nearest(
    fleet: Fleet,
    b: int,
    p: int,
    t: int,
    view: View,
    least: float,
    least_ahead: float,
    unit: float,
) -> None:
    """Turn the distances left in columns 6 and 10 into logarithms of their excess of the least."""
    for j in range(view.pair.shape[3]):
        if not fleet.visited[b, p, j]:
            pair = view.pair[b, p, t, j]
            pair[6] = math.log1p((pair[6] - least) * unit)
            pair[10] = math.log1p((pair[10] - least_ahead) * unit)


@inner
def describe_pairs(scene: Scene, fleet: Fleet, b: int, p: int, t: int, view: View) -> None:
    """Fill what relates the active UAV to each unvisited waypoint, and the state drawn from it."""
    waypoints = scene.waypoints.shape[1]
    active, now = view.active[b, p, t], view.now[b, p, t]
    total = 0
    for j in range(waypoints):
        total += scene.waypoint_valid[b, j]
    unit = math.sqrt(total)
    here, back = fleet.target[b, p, active], fleet.origin[b, p, active]
    hx, hy, hz = here[0] - back[0], here[1] - back[1], here[2] - back[2]
    heading = norm(hx, hy, hz)
    least, least_ahead, least_lead, own_ground, left = np.inf, np.inf, np.inf, 0, 0
    for j in range(waypoints):
        if fleet.visited[b, p, j]:
            continue
        left += 1
        pair = view.pair[b, p, t, j]
        x, y, z = scene.waypoints[b, j, 0], scene.waypoints[b, j, 1], scene.waypoints[b, j, 2]
        dx, dy, dz = x - here[0], y - here[1], z - here[2]
        away = norm(dx, dy, dz)
        rival, soonest = _rivals(scene, fleet, b, p, active, now, x, y, z)
        first, second, close = _others(scene, fleet, b, p, j, unit)
        duration = view.duration[b, p, t, j]
        turn = (hx * dx + hy * dy + hz * dz) / max(heading * away, 1e-9)
        pair[0] = math.log1p(away * unit)
        pair[1] = math.log1p(rival * unit)
        pair[2] = away * unit / 4
        pair[3] = (scene.t_max[b, active] - now - duration) / scene.t_max[b, active]
        pair[4] = math.log1p(first * unit)
        pair[5] = math.log1p(second * unit)
        pair[6] = away
        pair[7] = min(max(soonest - duration, -2.0), 2.0) * unit / 4
        pair[8] = turn
        pair[9] = close / 8
        pair[10] = away + first
        least = min(least, away)
        least_ahead = min(least_ahead, away + first)
        least_lead = min(least_lead, away - rival)
        own_ground += away < rival
    _relate_to_nearest(fleet, b, p, t, view, least, least_ahead, unit)
    state = view.state[b, p, t]
    if left > 0:
        state[9] = math.log1p(least * unit)
        state[10] = min(max(least_lead * unit, -8.0), 8.0) / 4
        state[11] = own_ground / left


@inner
def describe_state(
    scene: Scene, fleet: Fleet, b: int, p: int, t: int, other: float, view: View, degree: Array
) -> None:
    """Fill T and K of the active UAV and of the fleet."""
    uavs, waypoints = scene.speed.shape[1], scene.waypoints.shape[1]
    active, now = view.active[b, p, t], view.now[b, p, t]
    left, total = 0, 0
    for j in range(waypoints):
        left += not fleet.visited[b, p, j]
        total += scene.waypoint_valid[b, j]
    flying, fleet_size, capacity, least = 0, 0, 0.0, 10**6
    for a in range(uavs):
        flying += not fleet.done[b, p, a]
        fleet_size += scene.uav_valid[b, a]
        if not fleet.done[b, p, a]:
            capacity += max(scene.t_max[b, a] - fleet.arrive[b, p, a], 0.0)
        if scene.uav_valid[b, a]:
            least = min(least, degree[a])
    need = max(scene.k_min[b], 1)
    work = 0.7124 * left / math.sqrt(total)
    state = view.state[b, p, t]
    state[0] = now / scene.t_max[b, active]
    state[1] = scene.t_max[b, active] - now
    state[2] = 0.0 if other == np.inf else other - now
    state[3] = left / total
    state[4] = flying / fleet_size
    state[5] = min(work / max(capacity, 1e-3), 3.0)
    state[6] = min(degree[active] / need, 4.0)
    state[7] = min(least / need, 4.0)
    state[8] = 1.0 if other == np.inf else 0.0
