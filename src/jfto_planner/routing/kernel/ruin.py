"""Ruin and recreate: slack induction by string removals (Christiaens, Vanden Berghe 2020)."""

from __future__ import annotations

import numpy as np

from jfto_planner.routing.kernel.prng import Seed, below, uniform
from jfto_planner.routing.kernel.tables import LATE, OVERFULL_S, State, Tables, Work
from jfto_world.compiled import inner

# Figures of the paper: mean number of removed waypoints, longest string, share of split strings,
# chance that a split string grows further, chance that the recreation overlooks a position.
MEAN_REMOVED = 10.0
LONGEST_STRING = 10
SPLIT_SHARE = 0.5
SPLIT_STOP = 0.99
BLINK = 0.01


@inner
def copy_routes(cur: State, cand: State, work: Work) -> None:
    """Make the candidate's sequences those of the current state, all unmarked."""
    for a in range(cur.size.shape[0]):
        count = cur.size[a]
        cand.size[a] = count
        for i in range(count):
            cand.seq[a, i] = cur.seq[a, i]
        work.changed[a] = False


@inner
def remove_unrouted(cur: State, work: Work) -> int:
    """Write the waypoints that are on no route to work.removed; returns how many."""
    removed = 0
    for node in range(cur.route_of.shape[0]):
        if cur.route_of[node] < 0:
            work.removed[removed] = node
            removed += 1
    return removed


@inner
def ruin(tables: Tables, cur: State, cand: State, work: Work, rng: Seed) -> int:
    """Remove strings of waypoints near a random one; returns how many went to work.removed."""
    waypoints = cur.route_of.shape[0]
    uavs = cur.size.shape[0]
    busy = 0
    for a in range(uavs):
        busy += 1 if cur.size[a] > 0 else 0
    longest = min(LONGEST_STRING, max(1.0, np.floor(waypoints / busy)))
    strings = int(uniform(rng) * (4.0 * MEAN_REMOVED / (1.0 + longest) - 1.0) + 1.0)
    centre = below(rng, waypoints)
    removed, i = 0, -1
    while strings > 0 and i < tables.near.shape[1]:
        there = centre
        if i >= 0:
            there = int(tables.near[centre, i])
        i += 1
        route = np.int64(cur.route_of[there])
        if work.changed[route]:
            continue
        size = 1 + below(rng, np.int64(min(longest, cur.size[route])))
        removed = remove_string(cur, cand, work, rng, there, size, removed)
        work.changed[route] = True
        strings -= 1
    return removed


@inner
def remove_string(
    cur: State, cand: State, work: Work, rng: Seed, there: int, size: int, removed: int
) -> int:
    """Remove `size` waypoints around one, perhaps keeping some within; returns the new count."""
    a, at = np.int64(cur.route_of[there]), np.int64(cur.index_of[there])
    count = cur.size[a]
    kept = 0
    if size > 1 and size < count and uniform(rng) < SPLIT_SHARE:
        kept = 1
        while size + kept < count and uniform(rng) > SPLIT_STOP:
            kept += 1
    window = size + kept
    low = max(0, at - window + 1)
    high = min(at, count - window)
    begin = low + below(rng, high - low + 1)
    keep_from = begin + 1 + below(rng, size) if kept > 0 else begin + window
    out = begin
    for i in range(begin, count):
        inside = i < begin + window and not keep_from <= i < keep_from + kept
        if inside:
            work.removed[removed] = cur.seq[a, i]
            removed += 1
        else:
            cand.seq[a, out] = cur.seq[a, i]
            out += 1
    cand.size[a] = out
    return removed


@inner
def sort_removed(tables: Tables, work: Work, rng: Seed, removed: int) -> None:
    """Order the removed waypoints at random, far ones first or near ones first (4 : 2 : 1)."""
    waypoints = work.removed.shape[0]
    draw = below(rng, 7)
    for i in range(removed):
        node = work.removed[i]
        if draw < 4:
            key = uniform(rng)
        else:
            key = np.inf
            for pad in range(waypoints, tables.dist.shape[0]):
                key = min(key, tables.dist[pad, node])
            if draw < 6:
                key = -key
        j = i
        while j > 0 and work.sort_key[j - 1] > key:
            work.sort_key[j] = work.sort_key[j - 1]
            work.removed[j] = work.removed[j - 1]
            j -= 1
        work.sort_key[j] = key
        work.removed[j] = node


@inner
def skip_length(tables: Tables, rng: Seed) -> int:
    """Draw how many positions are looked at until one is overlooked."""
    table = tables.exponential
    return int(table[below(rng, table.shape[0])] / BLINK)


@inner
def route_duration(tables: Tables, state: State, uav: int) -> float:
    """Return the time of a whole route, leg by leg."""
    legs = tables.leg[tables.speed_class[uav]]
    here = tables.dist.shape[0] - state.seq.shape[0] + uav
    time = 0.0
    for i in range(state.size[uav]):
        there = state.seq[uav, i]
        time += legs[here, there]
        here = there
    return time


@inner
def insert(state: State, uav: int, position: int, node: int) -> None:
    """Insert a waypoint into a route before a position."""
    i = state.size[uav]
    while i > position:
        state.seq[uav, i] = state.seq[uav, i - 1]
        i -= 1
    state.seq[uav, position] = node
    state.size[uav] += 1


@inner
def recreate(
    tables: Tables, weights: np.ndarray, cand: State, work: Work, rng: Seed, removed: int
) -> None:
    """Insert the removed waypoints where each costs least, at times overlooking a place."""
    uavs = cand.size.shape[0]
    for a in range(uavs):
        work.spent[a] = route_duration(tables, cand, a)
    skip = skip_length(tables, rng)
    for k in range(removed):
        node = work.removed[k]
        best, best_uav, best_position, best_time = np.inf, 0, 0, 0.0
        to_node = tables.dist[node]
        for a in range(uavs):
            legs = tables.leg[tables.speed_class[a]]
            slack = tables.t_max[a] - work.spent[a]
            count = cand.size[a]
            full = weights[LATE] * OVERFULL_S if count >= tables.most[a] else 0.0
            here = tables.dist.shape[0] - uavs + a
            for position in range(count + 1):
                extra = to_node[here] + full
                there = node
                if position < count:
                    there = np.int64(cand.seq[a, position])
                    extra += to_node[there] - tables.dist[here, there]
                if extra < best:
                    time = legs[here, node]
                    if position < count:
                        time += legs[node, there] - legs[here, there]
                    extra += weights[LATE] * max(0.0, time - max(slack, 0.0))
                    if extra < best:
                        if skip > 0:
                            best, best_uav, best_position, best_time = extra, a, position, time
                        else:
                            skip = skip_length(tables, rng)
                        skip -= 1
                here = there
        insert(cand, best_uav, best_position, node)
        work.spent[best_uav] += best_time
        work.changed[best_uav] = True
