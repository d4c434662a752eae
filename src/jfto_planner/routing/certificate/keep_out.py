"""No-fly zones and the fence along the whole flight, ways home included.

Shares no code with the planning of ways round: rings and circles are measured here on the plane.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from jfto_msgs_py.records.certificate import Violation
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.site import Polygon, Ring, Zone
from jfto_msgs_py.types import Array, Flags
from jfto_planner.routing.certificate.home import home_places_m, home_times_s
from jfto_planner.routing.certificate.routes import fly

# Straight flight is looked at in pieces this long, so that each has a height of its own; curves
# from instant to instant, whose chords leave an arc by a hundredth of a metre at 10 m/s².
PIECE_M, STEP_S = 1.0, 0.1
STRAIGHT = "constant_speed"
TOLERANCE_M = 0.02


def check_keep_out(plan: Plan) -> list[Violation]:
    """One violation for each UAV and zone, or polygon to be kept in, at the worst place."""
    fence = plan.fence
    if fence is None:
        return []
    found = []
    for a, uav in enumerate(plan.uavs):
        places, times = _flight(plan, a)
        asked = [("keep_out", f"zone {z.name}", zone_room_m(places, z, fence.margin_m))
                 for z in fence.keep_out]  # fmt: skip
        asked += [("keep_in", f"fence.keep_in[{k}]", keep_in_room_m(places, part))
                  for k, part in enumerate(fence.keep_in)]  # fmt: skip
        for kind, name, room in asked:
            worst = int(np.argmin(room)) if len(room) else 0
            if not len(room) or room[worst] >= fence.margin_m - TOLERANCE_M:
                continue
            gap, at_s = float(room[worst]), float(times[worst])
            if kind == "keep_out":
                where = f"is in {name}" if gap <= 0 else f"comes within {gap:.1f} m of {name}"
            else:
                where = f"leaves {name}" if gap <= 0 else f"comes within {gap:.1f} m of its edge"
            message = f"{uav.id} {where} at {at_s:.1f} s, {fence.margin_m:g} m are wanted"
            slot = at_s / plan.slots.duration_s
            found.append(Violation(kind, uav.id, slot, at_s, gap, fence.margin_m, message))
    return found


def _flight(plan: Plan, a: int) -> tuple[Array, Array]:
    """Where a UAV is (T, 3), close enough for straight pieces between, and when (T,)."""
    home = plan.homes[a] if plan.homes else None
    if plan.time_model == STRAIGHT:
        route = plan.routes[a]
        line = plan.line_m(a)
        times: Array = np.array([0.0, *route.arrival_s], dtype=np.float64)
        if home is not None:
            line = np.concatenate([line, home.line_m])
            times = np.concatenate([times, np.array(home.reached_s, dtype=np.float64)])
        return _in_pieces(line, times)
    finer = max(1, int(np.ceil(plan.slots.duration_s / STEP_S)))
    places: Array = fly(plan, finer).positions_m[:, a]
    times = np.linspace(0.0, plan.slots.horizon_s, len(places))
    if home is not None:
        after = home_times_s(plan, STEP_S)
        places = np.concatenate([places, home_places_m(plan, after)[:, a]])
        times = np.concatenate([times, after])
    return places, times


def _in_pieces(line: Array, times: Array) -> tuple[Array, Array]:
    places, when = [line[:1]], [times[:1]]
    for (begin, end), (from_s, to_s) in zip(pairwise(line), pairwise(times), strict=True):
        count = max(1, int(np.ceil(np.linalg.norm(end - begin) / PIECE_M)))
        share = np.arange(1, count + 1) / count
        places.append(begin + share[:, None] * (end - begin))
        when.append(from_s + share * (to_s - from_s))
    return np.concatenate(places), np.concatenate(when)


def zone_room_m(places_m: Array, zone: Zone, margin_m: float) -> Array:
    """How far each piece of a flight (T, 3) stays from a zone in plan view, (T - 1,).

    0 and less inside; infinite where it is more than `margin_m` above or below it.
    """
    low = -np.inf if zone.bottom_m is None else zone.bottom_m - margin_m
    high = np.inf if zone.top_m is None else zone.top_m + margin_m
    z = places_m[:, 2]
    level = (np.maximum(z[:-1], z[1:]) > low + TOLERANCE_M) & (
        np.minimum(z[:-1], z[1:]) < high - TOLERANCE_M
    )
    room = np.full(len(level), np.inf)
    begin, end = places_m[:-1, :2][level], places_m[1:, :2][level]
    if zone.radius_m > 0:
        middle = np.array(zone.centre_m)
        room[level] = _to_piece(middle[None, :], begin, end) - zone.radius_m
    else:
        room[level] = _ring_room_m(begin, end, zone.outer)
    return room


def keep_in_room_m(places_m: Array, part: Polygon) -> Array:
    """How far each piece of a flight (T, 3) stays from the edge of a polygon inside it, (T - 1,).

    0 and less where it is not inside.
    """
    begin, end = places_m[:-1, :2], places_m[1:, :2]
    outside = ~_inside(begin, np.array(part.outer))
    room = np.where(outside, -1e-6, np.abs(_edge_distance(begin, end, np.array(part.outer))))
    for hole in part.holes:
        room = np.minimum(room, _ring_room_m(begin, end, hole))
    return room


def _ring_room_m(begin: Array, end: Array, ring: Ring) -> Array:
    """Distance (S,) of pieces to a ring; negative, by the distance to its edge, inside."""
    corners = np.array(ring)
    apart = _edge_distance(begin, end, corners)
    return np.where(_inside(begin, corners), -np.maximum(apart, 1e-6), apart)


def _edge_distance(begin: Array, end: Array, corners: Array) -> Array:
    """Least distance (S,) of pieces to the edges of a ring (V, 2); 0 where they cross."""
    found = np.full(len(begin), np.inf)
    for a, b in pairwise(np.concatenate([corners, corners[:1]])):
        apart = np.minimum(_to_piece(a[None, :], begin, end), _to_piece(b[None, :], begin, end))
        edge_a, edge_b = np.broadcast_to(a, begin.shape), np.broadcast_to(b, begin.shape)
        for point in (begin, end):
            apart = np.minimum(apart, _to_piece(point, edge_a, edge_b))
        sides = _side(begin, end, a) * _side(begin, end, b) < 0
        crosses = sides & (_side(edge_a, edge_b, begin) * _side(edge_a, edge_b, end) < 0)
        found = np.minimum(found, np.where(crosses, 0.0, apart))
    return found


def _to_piece(point: Array, begin: Array, end: Array) -> Array:
    """Distance of points to straight pieces (S, 2), row by row."""
    step = end - begin
    square = (step**2).sum(axis=1)
    along = ((point - begin) * step).sum(axis=1)
    share = np.clip(np.divide(along, square, out=np.zeros_like(along), where=square > 0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(point - begin - share[:, None] * step, axis=1))


def _side(begin: Array, end: Array, point: Array) -> Array:
    step, out = end - begin, point - begin
    return np.asarray(step[:, 0] * out[:, 1] - step[:, 1] * out[:, 0])


def _inside(points: Array, corners: Array) -> Flags:
    """Whether points (S, 2) lie in a ring (V, 2): they do if a ray east crosses it oddly."""
    odd = np.zeros(len(points), dtype=np.bool_)
    for a, b in pairwise(np.concatenate([corners, corners[:1]])):
        between = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        rise = b[1] - a[1] if b[1] != a[1] else 1.0
        cut = a[0] + (points[:, 1] - a[1]) / rise * (b[0] - a[0])
        odd ^= between & (points[:, 0] < cut)
    return odd
