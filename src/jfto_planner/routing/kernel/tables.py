"""The arrays on which the kernels work."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_world.kernel_struct import KernelStruct

# Entries of State.total.
LENGTH, LATE, RADIO, SEPARATION, ENERGY = range(5)
TOTALS = 5
# A waypoint more than a route may have is a violation like arriving so much later.
OVERFULL_S = 20.0


@dataclass(frozen=True, eq=False)
class Tables(KernelStruct):
    """What does not change during a search.

    Nodes 0 … W-1 are waypoints, node W + a is the pad of UAV a. `dist` is (M, M) in metres and
    `leg` (C, M, M) in seconds, one layer per class of UAVs with the same limits; `xyz` is (M, 3).
    `near` (W, k) lists the nearest waypoints of each. `slot_s` is the step of the search's own
    time grid, which has `slots` steps from lift-off to the latest permitted arrival; `fine_slots`
    is 10 N, `hold_s` the given horizon or 0 for the makespan. `reach_exact` (A, A) is the shorter
    of both ranges, `reach` what the grid goes by, perhaps less. `near_sq` (A, A) is the squared
    distance beyond which a pair cannot meet before the next grid instant. `energy_limit`
    (A,) is in the unit of the energy proxy (energy.py), inf while the proxy is off. `most` (A,) is
    how many waypoints a route may have. `exponential` is a quantile table.
    """

    dist: Array
    leg: Array
    speed_class: Ints
    xyz: Array
    near: NDArray[np.int32]
    t_max: Array
    reach: Array
    near_sq: Array
    energy_limit: Array
    most: Array
    reach_exact: Array
    k_min: int
    d_min: float
    slot_s: float
    slots: int
    fine_slots: int
    hold_s: float
    power_exponent: float
    exponential: Array
    via: NDArray[np.int32]
    via_first: Ints
    via_xyz: Array
    via_share: Array


@dataclass(frozen=True, eq=False)
class State(KernelStruct):
    """Routes and all that follows from them.

    `seq` (A, W) holds waypoint indices, the first `size[a]` of row a; `arrival` and `prefix`
    (A, W + 1) hold the time and the length flown at the pad (column 0) and at each waypoint.
    `route_of` and `index_of` (W,) invert `seq`. `pos` is (A, 3, slots + 1), `mask` (A, slots + 1)
    the set of neighbours as bits, `deficit` (slots + 1,) the radio penalty of each grid instant,
    `close` (A, A) the separation penalty of each pair, `total` the sums (tables.LENGTH, …).
    """

    seq: NDArray[np.int32]
    size: Ints
    arrival: Array
    prefix: Array
    route_of: NDArray[np.int32]
    index_of: NDArray[np.int32]
    pos: Array
    mask: NDArray[np.uint64]
    deficit: Array
    close: Array
    total: Array


@dataclass(frozen=True, eq=False)
class Work(KernelStruct):
    """Scratch memory of one search thread.

    `changed` (A,) marks the routes of the candidate that differ from the current ones, `first` (1,)
    holds the first grid instant at which they do; `ratio` (A, A) and `nearest` (A,) serve one grid
    instant, `need` and `spent` (A,) the energy proxy, `pieces`, `piece_count`, `ends` (2,) and
    `difference` (1,) a local move, `removed` and `sort_key` (W,) ruin and recreate; `sound` counts
    per constraint how often it held.
    """

    changed: Flags
    first: Ints
    ratio: Array
    nearest: Array
    need: Array
    spent: Array
    pieces: Ints
    piece_count: Ints
    ends: Ints
    sound: Ints
    difference: Array
    removed: Ints
    sort_key: Array


def empty_work(uav_count: int, waypoint_count: int) -> Work:
    """Return scratch memory for a fleet and a number of waypoints."""
    return Work(
        changed=np.zeros(uav_count, dtype=np.bool_),
        first=np.zeros(1, dtype=np.int64),
        ratio=np.zeros((uav_count, uav_count)),
        nearest=np.zeros(uav_count),
        need=np.zeros(uav_count),
        spent=np.zeros(uav_count),
        pieces=np.zeros((2, 6, 4), dtype=np.int64),
        piece_count=np.zeros(2, dtype=np.int64),
        ends=np.zeros(2, dtype=np.int64),
        sound=np.zeros(TOTALS, dtype=np.int64),
        difference=np.zeros(1),
        removed=np.zeros(waypoint_count, dtype=np.int64),
        sort_key=np.zeros(waypoint_count),
    )


def empty_state(uav_count: int, waypoint_count: int, slots: int) -> State:
    """Return a state without routes; infinite LENGTH marks it as not evaluated."""
    return State(
        seq=np.zeros((uav_count, waypoint_count), dtype=np.int32),
        size=np.zeros(uav_count, dtype=np.int64),
        arrival=np.zeros((uav_count, waypoint_count + 1)),
        prefix=np.zeros((uav_count, waypoint_count + 1)),
        route_of=np.full(waypoint_count, -1, dtype=np.int32),
        index_of=np.zeros(waypoint_count, dtype=np.int32),
        pos=np.zeros((uav_count, 3, slots + 1)),
        mask=np.zeros((uav_count, slots + 1), dtype=np.uint64),
        deficit=np.zeros(slots + 1),
        close=np.zeros((uav_count, uav_count)),
        total=np.full(TOTALS, np.inf),
    )
