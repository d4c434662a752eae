"""Local moves between neighbouring waypoints, written as pieces of the current routes.

A piece is (route, begin, end, reversed): the waypoints begin … end - 1 of a current route. A move
lists the pieces of which one or two new routes consist; length differences follow from their
joints, so that most candidates are rejected before any route is built.
"""

from __future__ import annotations

import numpy as np

from jfto_planner.routing.kernel.prng import Seed, below, uniform
from jfto_planner.routing.kernel.tables import State, Tables, Work
from jfto_world.compiled import inner

LONGEST_SEGMENT = 3
NEIGHBOURS = 12


@inner
def put(work: Work, side: int, route: int, begin: int, end: int, backward: bool) -> None:
    """Append a piece to the first or second new route of a move."""
    if begin >= end:
        return
    piece = work.pieces[side, work.piece_count[side]]
    piece[0], piece[1], piece[2], piece[3] = route, begin, end, np.int64(backward)
    work.piece_count[side] += 1


@inner
def relocate(
    state: State, work: Work, segment: tuple[int, int, int, bool], r2: int, at: int
) -> bool:
    """Move a piece of a route to before position `at` of r2 (Or-opt)."""
    r1, begin, end, backward = segment
    n1, n2 = state.size[r1], state.size[r2]
    if r1 != r2:
        put(work, 0, r1, 0, begin, False)
        put(work, 0, r1, end, n1, False)
        put(work, 1, r2, 0, at, False)
        put(work, 1, r1, begin, end, backward)
        put(work, 1, r2, at, n2, False)
        return True
    if begin <= at <= end:
        return False
    if at < begin:
        put(work, 0, r1, 0, at, False)
        put(work, 0, r1, begin, end, backward)
        put(work, 0, r1, at, begin, False)
        put(work, 0, r1, end, n1, False)
    else:
        put(work, 0, r1, 0, begin, False)
        put(work, 0, r1, end, at, False)
        put(work, 0, r1, begin, end, backward)
        put(work, 0, r1, at, n1, False)
    return True


@inner
def exchange(
    state: State,
    work: Work,
    first: tuple[int, int, int],
    second: tuple[int, int, int],
    flips: int,
) -> bool:
    """Exchange two segments (route, begin, end), each perhaps reversed (swap, cross-exchange)."""
    r1, i, end1 = first
    r2, j, end2 = second
    if r1 != r2:
        put(work, 0, r1, 0, i, False)
        put(work, 0, r2, j, end2, flips & 1 > 0)
        put(work, 0, r1, end1, state.size[r1], False)
        put(work, 1, r2, 0, j, False)
        put(work, 1, r1, i, end1, flips & 2 > 0)
        put(work, 1, r2, end2, state.size[r2], False)
        return True
    if i > j:
        i, end1, j, end2 = j, end2, i, end1
    if end1 > j:
        return False
    put(work, 0, r1, 0, i, False)
    put(work, 0, r1, j, end2, flips & 1 > 0)
    put(work, 0, r1, end1, j, False)
    put(work, 0, r1, i, end1, flips & 2 > 0)
    put(work, 0, r1, end2, state.size[r1], False)
    return True


@inner
def reconnect(state: State, work: Work, r1: int, i: int, r2: int, j: int, backward: bool) -> bool:
    """Join waypoint i of r1 to waypoint j of r2 (2-opt; tail exchange; reversal across routes)."""
    n1, n2 = state.size[r1], state.size[r2]
    if r1 == r2:
        begin, end = min(i, j), max(i, j)
        if backward:
            begin, end = begin - 1, end - 1
        put(work, 0, r1, 0, begin + 1, False)
        put(work, 0, r1, begin + 1, end + 1, True)
        put(work, 0, r1, end + 1, n1, False)
        return end - begin > 1
    if backward:
        put(work, 0, r1, 0, i + 1, False)
        put(work, 0, r2, 0, j + 1, True)
        put(work, 1, r1, i + 1, n1, True)
        put(work, 1, r2, j + 1, n2, False)
    else:
        put(work, 0, r1, 0, i + 1, False)
        put(work, 0, r2, j, n2, False)
        put(work, 1, r2, 0, j, False)
        put(work, 1, r1, i + 1, n1, False)
    return True


@inner
def propose(tables: Tables, state: State, work: Work, rng: Seed) -> bool:
    """Write a random move into work.pieces; False where the draw makes none.

    Sets work.changed, work.ends (the routes that it renews) and work.difference.
    """
    work.piece_count[:] = 0
    work.changed[:] = False
    c = below(rng, state.route_of.shape[0])
    d = tables.near[c, below(rng, min(NEIGHBOURS, tables.near.shape[1]))]
    r1, i = np.int64(state.route_of[c]), np.int64(state.index_of[c])
    r2, j = np.int64(state.route_of[d]), np.int64(state.index_of[d])
    kind, flips = below(rng, 4), below(rng, 4)
    size = 1 + below(rng, LONGEST_SEGMENT)
    if kind == 0 and uniform(rng) < 0.1:  # to the head or the end of any route, even an empty one
        r2 = below(rng, state.size.shape[0])
        at = 0 if flips < 2 else state.size[r2]
        end = min(i + size, state.size[r1])
        sound = relocate(state, work, (r1, i, end, flips % 2 > 0), r2, at)
    elif kind == 0:  # c comes next to d, at either end of its segment
        begin = i if flips < 2 else max(0, i - size + 1)
        end = min(i + size, state.size[r1]) if flips < 2 else i + 1
        after = flips % 2 == 0
        backward = after == (flips >= 2)
        sound = relocate(state, work, (r1, begin, end, backward), r2, j + np.int64(after))
    elif kind == 1:  # c's segment changes places with the one behind d
        size2 = 1 + below(rng, LONGEST_SEGMENT)
        end1 = min(i + size, state.size[r1])
        end2 = min(j + 1 + size2, state.size[r2])
        first, second = (r1, i, end1), (r2, j + 1, end2)
        sound = j + 1 < end2 and exchange(state, work, first, second, flips)
    else:
        sound = reconnect(state, work, r1, i, r2, j, kind == 3)
    if sound:
        work.changed[r1] = True
        work.changed[r2] = True
        work.difference[0] = length_difference(tables, state, work, r1, r2)
        work.ends[0], work.ends[1] = r1, r2
    return sound


@inner
def length_difference(tables: Tables, state: State, work: Work, r1: int, r2: int) -> float:
    """Length of the new routes less that of those they replace, from the joints."""
    difference = 0.0
    uavs = state.size.shape[0]
    for side in range(2 if r1 != r2 else 1):
        route = r1 if side == 0 else r2
        here = tables.dist.shape[0] - uavs + route
        difference -= state.prefix[route, state.size[route]]
        for k in range(work.piece_count[side]):
            piece = work.pieces[side, k]
            source, begin, end = piece[0], piece[1], piece[2]
            head, foot = state.seq[source, begin], state.seq[source, end - 1]
            if piece[3] > 0:
                head, foot = foot, head
            difference += tables.dist[here, head]
            difference += state.prefix[source, end] - state.prefix[source, begin + 1]
            here = np.int64(foot)
    return difference


@inner
def assemble(state: State, cand: State, work: Work) -> None:
    """Build the new routes of the candidate from their pieces."""
    for side in range(2 if work.ends[0] != work.ends[1] else 1):
        assemble_route(state, cand, work, side, work.ends[side])


@inner
def assemble_route(state: State, cand: State, work: Work, side: int, route: int) -> None:
    """Build one new route of the candidate from its pieces."""
    out = 0
    for k in range(work.piece_count[side]):
        piece = work.pieces[side, k]
        for offset in range(piece[2] - piece[1]):
            i = piece[2] - 1 - offset if piece[3] > 0 else piece[1] + offset
            cand.seq[route, out] = state.seq[piece[0], i]
            out += 1
    cand.size[route] = out
