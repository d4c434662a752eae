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
            x, y, z = tables.xyz[here, 0], tables.xyz[here, 1], tables.xyz[here, 2]
            pace = 1.0 / (end - begin)
            dx = (tables.xyz[there, 0] - x) * pace
            dy = (tables.xyz[there, 1] - y) * pace
            dz = (tables.xyz[there, 2] - z) * pace
            while slot <= last and slot * step_s < end:
                ago = slot * step_s - begin
                out[0, slot] = x + dx * ago
                out[1, slot] = y + dy * ago
                out[2, slot] = z + dz * ago
                slot += 1
        here = there
    for k in range(3):
        for later in range(slot, last + 1):
            out[k, later] = tables.xyz[here, k]
