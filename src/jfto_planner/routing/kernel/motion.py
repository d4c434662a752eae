"""Times, lengths and grid positions of one route."""

from __future__ import annotations

import numpy as np

from jfto_planner.routing.kernel.tables import State, Tables
from jfto_world.compiled import inner


@inner
def time_route(tables: Tables, state: State, uav: int, first: int) -> None:
    """Renew `arrival` and `prefix` of a route from its waypoint number `first` on."""
    seq = state.seq[uav]
    legs = tables.leg[tables.speed_class[uav]]
    pad = tables.dist.shape[0] - state.seq.shape[0] + uav
    here = pad if first == 0 else seq[first - 1]
    time = state.arrival[uav, first]
    length = state.prefix[uav, first]
    for i in range(first, state.size[uav]):
        there = seq[i]
        time += legs[here, there]
        length += tables.dist[here, there]
        state.arrival[uav, i + 1] = time
        state.prefix[uav, i + 1] = length
        here = there


@inner
def fill_piece(
    out: np.ndarray,
    slot: int,
    step_s: float,
    begin: tuple[float, float, float],
    end: tuple[float, float, float],
    span_s: tuple[float, float],
) -> int:
    """Write positions on a straight piece flown during span_s, from `slot` on; the next slot."""
    begin_s, end_s = span_s
    pace = 1.0 / (end_s - begin_s)
    dx, dy, dz = (end[0] - begin[0]) * pace, (end[1] - begin[1]) * pace, (end[2] - begin[2]) * pace
    last = out.shape[1] - 1
    while slot <= last and slot * step_s < end_s:
        ago = slot * step_s - begin_s
        out[0, slot] = begin[0] + dx * ago
        out[1, slot] = begin[1] + dy * ago
        out[2, slot] = begin[2] + dz * ago
        slot += 1
    return slot


@inner
def fill_positions(
    tables: Tables, state: State, uav: int, step_s: float, first: int, out: np.ndarray
) -> None:
    """Write positions at the instants `first` … of a grid of `step_s` into `out` (3, slots + 1)."""
    seq, arrival = state.seq[uav], state.arrival[uav]
    count = state.size[uav]
    pad = tables.dist.shape[0] - state.seq.shape[0] + uav
    slot, last = first, out.shape[1] - 1
    here = pad
    for i in range(count):
        there = seq[i]
        begin, end = arrival[i], arrival[i + 1]
        if slot * step_s < end:
            place = (tables.xyz[here, 0], tables.xyz[here, 1], tables.xyz[here, 2])
            from_s = begin
            k = tables.via[here, there] if tables.via.shape[0] > 0 else np.int32(-1)
            if k >= 0:
                share = tables.via_share[tables.speed_class[uav]]
                for p in range(tables.via_first[k], tables.via_first[k + 1]):
                    via = (tables.via_xyz[p, 0], tables.via_xyz[p, 1], tables.via_xyz[p, 2])
                    until_s = begin + share[p] * (end - begin)
                    if slot * step_s < until_s:
                        slot = fill_piece(out, slot, step_s, place, via, (from_s, until_s))
                    place, from_s = via, until_s
            goal = (tables.xyz[there, 0], tables.xyz[there, 1], tables.xyz[there, 2])
            if slot * step_s < end:
                slot = fill_piece(out, slot, step_s, place, goal, (from_s, end))
        here = there
    for k in range(3):
        for later in range(slot, last + 1):
            out[k, later] = tables.xyz[here, k]
