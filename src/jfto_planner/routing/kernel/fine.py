"""The per-instant rules on the exact time grid, ten times finer than the slots."""

from __future__ import annotations

import numpy as np

from jfto_planner.routing.kernel.evaluate import makespan
from jfto_planner.routing.kernel.motion import fill_positions
from jfto_planner.routing.kernel.radio import scan_pair, slot_is_sound
from jfto_planner.routing.kernel.tables import State, Tables, Work
from jfto_world.compiled import inlined


@inlined
def is_sound(tables: Tables, state: State, work: Work, pos: np.ndarray, mask: np.ndarray) -> bool:
    """Tell whether separation, neighbours and connectivity hold at all 10 N + 1 instants.

    `pos` (A, 3, 10 N + 1) and `mask` (A, 10 N + 1) are scratch memory.
    """
    uavs = state.size.shape[0]
    last = tables.fine_slots
    work.changed[:] = False
    horizon_s = tables.hold_s if tables.hold_s > 0.0 else makespan(state, state, work)
    for a in range(uavs):
        fill_positions(tables, state, a, horizon_s / last, 0, pos[a])
    mask[:] = np.uint64(0)
    for a in range(uavs):
        for b in range(a):
            limits = (tables.reach_exact[a, b] ** 2, tables.d_min**2)
            if scan_pair(pos[a], pos[b], mask[a], mask[b], (a, b), limits, 0, last) > 0:
                return False
    everyone = ~np.uint64(0) >> np.uint64(64 - uavs)
    for slot in range(last + 1):  # noqa: SIM110 - numba compiles no generators into all()
        if not slot_is_sound(mask, slot, tables.k_min, everyone):
            return False
    return True
