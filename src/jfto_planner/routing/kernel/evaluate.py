"""What a candidate costs: length plus weighted violations, cheapest tests first.

And the rules on the exact time grid, ten times finer than the slots, for what is to be kept.
"""

from __future__ import annotations

import numpy as np

from jfto_planner.routing.kernel.energy import energy_excess, energy_spent
from jfto_planner.routing.kernel.motion import fill_positions, time_route
from jfto_planner.routing.kernel.radio import (
    renew_deficits,
    renew_pairs,
    scan_pair,
    slot_is_sound,
)
from jfto_planner.routing.kernel.tables import (
    ENERGY,
    LATE,
    LENGTH,
    OVERFULL_S,
    RADIO,
    SEPARATION,
    State,
    Tables,
    Work,
)
from jfto_world.compiled import inlined, inner


@inner
def cost_of(total: np.ndarray, weights: np.ndarray) -> float:
    """Length plus weighted violations; `weights` (5,) is indexed like State.total."""
    return (
        total[LENGTH]
        + weights[LATE] * total[LATE]
        + weights[RADIO] * total[RADIO]
        + weights[SEPARATION] * total[SEPARATION]
        + weights[ENERGY] * total[ENERGY]
    )


@inner
def common_head(cur: State, cand: State, uav: int) -> int:
    """Return how many leading waypoints of a route the candidate keeps, or -1 for all of them."""
    count = min(cur.size[uav], cand.size[uav])
    i = 0
    while i < count and cur.seq[uav, i] == cand.seq[uav, i]:
        i += 1
    if i == cur.size[uav] and i == cand.size[uav]:
        return -1
    return i


@inner
def makespan(cur: State, cand: State, work: Work) -> float:
    """Return the latest arrival of the candidate."""
    latest = 0.0
    for a in range(cand.size.shape[0]):
        state_latest = (
            cand.arrival[a, cand.size[a]] if work.changed[a] else cur.arrival[a, cur.size[a]]
        )
        latest = max(latest, state_latest)
    return latest


@inner
def time_and_length(tables: Tables, cur: State, cand: State, work: Work) -> int:
    """Renew times and lengths of the changed routes, and the candidate's LENGTH and LATE.

    Unmarks routes that are as before. Returns the first grid instant that can differ, or -1 where
    nothing does.
    """
    uavs = cand.size.shape[0]
    first = tables.slots + 1
    late, length = 0.0, 0.0
    fresh = cur.total[LENGTH] == np.inf
    nothing = True
    for a in range(uavs):
        head = common_head(cur, cand, a) if work.changed[a] else -1
        if fresh:
            head = 0
        work.changed[a] = head >= 0
        if head < 0:
            arrival, flown = cur.arrival[a, cur.size[a]], cur.prefix[a, cur.size[a]]
            count = cur.size[a]
        else:
            nothing = False
            for i in range(head + 1):
                cand.arrival[a, i] = cur.arrival[a, i]
                cand.prefix[a, i] = cur.prefix[a, i]
            time_route(tables, cand, a, head)
            arrival, flown = cand.arrival[a, cand.size[a]], cand.prefix[a, cand.size[a]]
            count = cand.size[a]
            first = min(first, int(cand.arrival[a, head] / tables.slot_s) + 1)
        late += max(0.0, arrival - tables.t_max[a])
        late += OVERFULL_S * max(0.0, count - tables.most[a])
        length += flown
    cand.total[LENGTH] = length
    cand.total[LATE] = late
    if fresh:
        return 0
    return -1 if nothing else first


@inlined
def evaluate(
    tables: Tables, weights: np.ndarray, cur: State, cand: State, work: Work, threshold: float
) -> float:
    """Cost of the candidate, or inf once it is known to reach `threshold`.

    The candidate's sequences and work.changed are given, the rest of it is renewed as far as
    needed.
    """
    first = time_and_length(tables, cur, cand, work)
    if first < 0:
        return np.inf
    cost = cand.total[LENGTH] + weights[LATE] * cand.total[LATE]
    if cost >= threshold:
        return np.inf
    uavs = cand.size.shape[0]
    end_s = makespan(cur, cand, work)
    latest = max(end_s, makespan(cur, cur, work))
    last = min(tables.slots, int(latest / tables.slot_s) + 1)
    first = min(first, last)
    work.first[0] = first
    for a in range(uavs):
        if work.changed[a]:
            fill_positions(tables, cand, a, tables.slot_s, max(first - 1, 0), cand.pos[a])
    cand.total[SEPARATION] = renew_pairs(tables, cur, cand, work, first, last)
    cost = cand.total[LENGTH] + weights[LATE] * cand.total[LATE]
    cost += weights[SEPARATION] * cand.total[SEPARATION]
    if cost >= threshold:
        return np.inf
    allowance = (threshold - cost) / weights[RADIO]
    cand.total[RADIO] = renew_deficits(tables, cur, cand, work, first, last, allowance)
    cost += weights[RADIO] * cand.total[RADIO]
    cand.total[ENERGY] = 0.0
    if cost < threshold and np.isfinite(tables.energy_limit[0]):
        horizon_s = tables.hold_s if tables.hold_s > 0.0 else end_s
        energy_spent(tables, cur, cand, work, last, horizon_s)
        cand.total[ENERGY] = energy_excess(tables, work)
        cost += weights[ENERGY] * cand.total[ENERGY]
    if cost >= threshold:
        return np.inf
    for slot in range(last + 1, tables.slots + 1):
        cand.deficit[slot] = 0.0
        for a in range(uavs):
            cand.mask[a, slot] = cand.mask[a, last]
    return cost


@inlined
def accept(cur: State, cand: State, work: Work) -> None:
    """Make a fully evaluated candidate the current state."""
    first = work.first[0]
    slots = cur.deficit.shape[0]
    for k in range(cur.total.shape[0]):
        cur.total[k] = cand.total[k]
    for slot in range(first, slots):
        cur.deficit[slot] = cand.deficit[slot]
    for a in range(cur.size.shape[0]):
        for b in range(a):
            cur.close[a, b] = cand.close[a, b]
        for slot in range(first, slots):
            cur.mask[a, slot] = cand.mask[a, slot]
        if work.changed[a]:
            count = cand.size[a]
            cur.size[a] = count
            for k in range(3):
                for slot in range(first, slots):
                    cur.pos[a, k, slot] = cand.pos[a, k, slot]
            for i in range(count):
                cur.seq[a, i] = cand.seq[a, i]
                cur.arrival[a, i + 1] = cand.arrival[a, i + 1]
                cur.prefix[a, i + 1] = cand.prefix[a, i + 1]
                cur.route_of[cur.seq[a, i]] = a
                cur.index_of[cur.seq[a, i]] = i


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
            if scan_pair(pos[a], pos[b], mask[a], mask[b], (a, b), limits, (0, last)) > 0:
                return False
    everyone = ~np.uint64(0) >> np.uint64(64 - uavs)
    for slot in range(last + 1):  # noqa: SIM110 - numba compiles no generators into all()
        if not slot_is_sound(mask, slot, tables.k_min, everyone):
            return False
    return True
