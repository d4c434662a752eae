"""Simulated annealing over ruin-and-recreate and local moves, with self-tuning penalties."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array, Ints
from jfto_planner.routing.kernel.evaluate import accept, cost_of, evaluate, is_sound
from jfto_planner.routing.kernel.local import assemble, propose
from jfto_planner.routing.kernel.prng import Seed, below, uniform
from jfto_planner.routing.kernel.ruin import (
    copy_routes,
    recreate,
    remove_unrouted,
    ruin,
    sort_removed,
)
from jfto_planner.routing.kernel.tables import (
    ENERGY,
    LATE,
    LENGTH,
    RADIO,
    SEPARATION,
    State,
    Tables,
    Work,
)
from jfto_world.compiled import inlined, inner, kernel
from jfto_world.kernel_struct import KernelStruct

# Entries of Search.counters.
TRIED, EVALUATED, ACCEPTED, IMPROVED, FINE_REJECTED = range(5)
COUNTERS = 5
# What counts as the violation of routes that are sound at the grid's instants only.
FINE_VIOLATION = 0.01
# Weights of penalties adapt after this many moves, so that the current routes are sound for about
# the given share of them (the target of PyVRP's penalty manager).
TUNE_EVERY = 1000
SOUND_SHARE = 0.3
WEIGHT_UP, WEIGHT_DOWN = 1.1, 0.95
WEIGHT_LEAST, WEIGHT_MOST = 2.0, 1e4


@dataclass(frozen=True, eq=False)
class Search(KernelStruct):
    """One search thread: current and candidate state, what it has found, and its random numbers.

    `best` and `closest` are states of which only seq, size and total are kept: the shortest sound
    routes (LENGTH inf while there are none) and those with the least violations. `violated` (1,)
    is the violation of the latter.
    """

    cur: State
    cand: State
    work: Work
    best: State
    closest: State
    violated: Array
    weights: Array
    fine_pos: Array
    fine_mask: NDArray[np.uint64]
    rng: Seed
    counters: Ints


@inner
def violation(total: np.ndarray) -> float:
    """Return one figure for all violations; 0 where the routes are sound on the search's grid."""
    return total[LATE] + total[RADIO] + total[SEPARATION] + 10.0 * total[ENERGY]


@inner
def keep(source: State, target: State) -> None:
    """Copy the routes and totals of a state."""
    for k in range(source.total.shape[0]):
        target.total[k] = source.total[k]
    for a in range(source.size.shape[0]):
        count = source.size[a]
        target.size[a] = count
        for i in range(count):
            target.seq[a, i] = source.seq[a, i]


@inlined
def record(tables: Tables, search: Search) -> None:
    """Keep the current routes if they are the best, or the closest to sound, so far."""
    cur = search.cur
    excess = violation(cur.total)
    if excess > 0.0:
        if excess < search.violated[0]:
            search.violated[0] = excess
            keep(cur, search.closest)
    elif cur.total[LENGTH] < search.best.total[LENGTH] - 1e-7:
        if is_sound(tables, cur, search.work, search.fine_pos, search.fine_mask):
            keep(cur, search.best)
            search.counters[IMPROVED] += 1
        else:
            search.counters[FINE_REJECTED] += 1
            if search.violated[0] > FINE_VIOLATION:
                search.violated[0] = FINE_VIOLATION
                keep(cur, search.closest)


@inlined
def try_move(tables: Tables, search: Search, ruin_share: float, threshold: float) -> float:
    """Draw and evaluate one candidate; returns its cost, or inf at or above `threshold`."""
    cur, cand, work, rng = search.cur, search.cand, search.work, search.rng
    if cur.total[LENGTH] == np.inf or uniform(rng) < ruin_share:
        copy_routes(cur, cand, work)
        if cur.total[LENGTH] == np.inf:
            removed = remove_unrouted(cur, work)
        else:
            removed = ruin(tables, cur, cand, work, rng)
        sort_removed(tables, work, rng, removed)
        recreate(tables, search.weights, cand, work, rng, removed)
    else:
        if not propose(tables, cur, work, rng):
            return np.inf
        if cur.total[LENGTH] + work.difference[0] >= threshold:
            return np.inf
        assemble(cur, cand, work)
    search.counters[EVALUATED] += 1
    return evaluate(tables, search.weights, cur, cand, work, threshold)


@inner
def tune(weights: np.ndarray, sound: np.ndarray, may_relax: bool) -> None:
    """Raise the weights of penalties that were seldom zero, lower those that mostly were."""
    for k in (LATE, RADIO, SEPARATION, ENERGY):
        if sound[k] < SOUND_SHARE * TUNE_EVERY:
            weights[k] = min(weights[k] * WEIGHT_UP, WEIGHT_MOST)
        elif may_relax:
            weights[k] = max(weights[k] * WEIGHT_DOWN, WEIGHT_LEAST)
        sound[k] = 0


@kernel
def anneal(
    tables: Tables,
    search: Search,
    moves: int,
    temperature: float,
    ruin_share: float,
    may_relax: bool,
) -> None:
    """Do `moves` moves at a temperature in metres.

    A current state of infinite LENGTH is first completed by greedy insertion and evaluated.
    """
    cur, rng, sound = search.cur, search.rng, search.work.sound
    table = tables.exponential
    cost = cost_of(cur.total, search.weights)
    for move in range(1, moves + 1):
        if move % TUNE_EVERY == 0:
            tune(search.weights, sound, may_relax)
            cost = cost_of(cur.total, search.weights)
        threshold = cost + temperature * table[below(rng, table.shape[0])]
        new_cost = try_move(tables, search, ruin_share, threshold)
        if new_cost < threshold:
            accept(cur, search.cand, search.work)
            cost = new_cost
            search.counters[ACCEPTED] += 1
            record(tables, search)
        for k in (LATE, RADIO, SEPARATION, ENERGY):
            sound[k] += np.int64(cur.total[k] == 0.0)
    search.counters[TRIED] += moves
