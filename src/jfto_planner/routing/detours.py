"""Legs that go round no-fly zones: where they pass, for the search, the checks and the plan."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.plan_file import DECIMALS
from jfto_msgs_py.types import Array, Flags, GroundHeight, Ints
from jfto_world.motion import MotionLimits, TimeModel

if TYPE_CHECKING:
    # Loads shapely, which only plans with a fence need.
    from jfto_world.site.free_space import FreeSpace

_SPACING_M = 2.5
# Beyond the clearance, as for straight legs: what rounded corners and the vehicle's error may take.
_LIFT_M = 1.5


@dataclass(frozen=True, eq=False)
class Detours:
    """Ways between nodes (M, 3), waypoints before pads, that are not straight.

    `index` (M, M) is -1 where a leg is straight; k there passes
    `points_m[first[k]:first[k + 1]]` (…, 3), ENU metres, in the order in which it is flown.
    """

    nodes_m: Array
    index: NDArray[np.int32]
    first: Ints
    points_m: Array

    def between(self, begin: int, end: int) -> Array:
        """Points (P, 3) passed on the way from one node to another, none where it is straight."""
        k = int(self.index[begin, end])
        return self.points_m[:0] if k < 0 else self.points_m[self.first[k] : self.first[k + 1]]

    @cached_property
    def chain_m(self) -> tuple[Array, Ints]:
        """Lines of all ways, ends included, one behind the other (Q, 3); where each begins (K,)."""
        begin, end = np.nonzero(self.index >= 0)
        order = np.argsort(self.index[begin, end])
        begin, end = begin[order], end[order]
        at = self.first[:-1]
        points = np.insert(self.points_m, at, self.nodes_m[begin], axis=0)
        starts = at + np.arange(len(at))
        closing = np.append(starts[1:], len(points))
        points = np.insert(points, closing, self.nodes_m[end], axis=0)
        return points, starts + np.arange(len(at))

    def per_way(self, pieces: Array) -> tuple[Array, Array]:
        """Sums of what pieces of the chain (Q - 1,) take.

        Of each way (M, M), nan where straight; and before each of `points_m` on its way (P,).
        """
        starts = self.chain_m[1]
        sums = np.concatenate([[0.0], np.cumsum(pieces)])
        counts = np.diff(self.first)
        total = np.append(sums[starts + counts + 1] - sums[starts], np.nan)
        way = np.repeat(np.arange(len(counts)), counts)
        before = sums[np.arange(len(self.points_m)) + 1 + 2 * way] - sums[starts[way]]
        return total[self.index], before

    @cached_property
    def lengths_m(self) -> Array:
        """Lengths (M, M) of the ways, nan where they are straight."""
        return self.per_way(np.linalg.norm(np.diff(self.chain_m[0], axis=0), axis=1))[0]


@lru_cache(maxsize=8)
def way_times(detours: Detours, model: TimeModel, limits: MotionLimits) -> tuple[Array, Array]:
    """How long ways take by a model's legs, s.

    Parameters
    ----------
    detours, model, limits
        Ways, and who flies them.

    Returns
    -------
    tuple of Array
        Times (M, M), nan where straight, and the share of its way's time at which each of
        `points_m` is passed (P,).
    """
    chain, _ = detours.chain_m
    found, before = detours.per_way(model.chain_times(chain, limits))
    way = np.repeat(np.arange(len(detours.first) - 1), np.diff(detours.first))
    total = np.zeros(len(detours.first) - 1)
    total[detours.index[detours.index >= 0]] = found[detours.index >= 0]
    return found, before / total[way]


def detours_of(
    free: FreeSpace,
    nodes_m: Array,
    pads_m: Array,
    ground: GroundHeight | None = None,
    clearance_m: float = 0.0,
) -> tuple[Detours, Flags]:
    """Ways round for every pair of nodes whose straight leg a fence does not allow.

    Parameters
    ----------
    free
        Where may be flown.
    nodes_m
        Waypoints, then the places (M, 3) above the pads from which first legs begin.
    pads_m
        The pads (A, 3) themselves.
    ground, clearance_m
        Height of the ground, and what ways round keep above it; None: heights between the ends'.

    Returns
    -------
    tuple of Detours and Flags
        The ways, and the pairs (M, M) between which there is none.
    """
    count, waypoint_count = len(nodes_m), len(nodes_m) - len(pads_m)
    a, b = np.triu_indices(count, 1)
    # Nobody flies from pad to pad.
    a, b = a[a < waypoint_count], b[a < waypoint_count]
    crossing = free.crossed(nodes_m[a], nodes_m[b])
    pairs = np.column_stack([a[crossing], b[crossing]])
    ways = free.ways(nodes_m, pairs)
    index = np.full((count, count), -1, dtype=np.int32)
    closed = np.zeros((count, count), dtype=np.bool_)
    points: list[Array] = []
    for k, (i, j) in enumerate(pairs):
        flat = ways.vias[ways.first[k] : ways.first[k + 1]]
        line = with_heights(nodes_m[i], flat, nodes_m[j])
        if ground is not None:
            line = _lifted(line, ground, clearance_m)
        if ways.closed[k] or free.crossed(line[:-1], line[1:]).any():
            closed[i, j] = closed[j, i] = True
            continue
        index[i, j], index[j, i] = len(points), len(points) + 1
        line = np.round(line, DECIMALS)
        points += [line[1:-1], line[-2:0:-1]]
    first = np.concatenate([[0], np.cumsum([len(each) for each in points])]).astype(np.int64)
    nodes_m = np.concatenate([nodes_m[:waypoint_count], pads_m])
    return Detours(nodes_m, index, first, np.concatenate([np.zeros((0, 3)), *points])), closed


def with_heights(begin_m: Array, flat_m: Array, end_m: Array) -> Array:
    """Line (P + 2, 3) through points (P, 2), its height even along its way in plan view."""
    plan = np.concatenate([begin_m[None, :2], flat_m, end_m[None, :2]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(plan, axis=0), axis=1))])
    share = along / max(float(along[-1]), 1e-9)
    return np.column_stack([plan, begin_m[2] + share * (end_m[2] - begin_m[2])])


def _lifted(line: Array, ground: GroundHeight, clearance_m: float) -> Array:
    """The line with its inner points so high that the ground is cleared, if that is possible."""
    places = _places(line)
    missing = ground(places[:, 0], places[:, 1]) + clearance_m - places[:, 2]
    worst = float(missing.max())
    if worst <= 1e-9:
        return line
    line = line.copy()
    line[1:-1, 2] += worst + _LIFT_M
    return line


def _places(line: Array) -> Array:
    """Places along a line but its ends, close enough to compare with the ground."""
    pieces = []
    for a, b in pairwise(line):
        steps = int(np.linalg.norm(b - a) / _SPACING_M) + 2
        pieces.append(a + (b - a) * np.linspace(0, 1, steps, endpoint=False)[:, None])
    return np.concatenate(pieces)[1:]
