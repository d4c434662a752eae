"""Where a fleet may fly between no-fly zones, and the shortest ways round them in plan view."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
import shapely
from scipy.sparse.csgraph import dijkstra

from jfto_msgs_py.records.site import Fence, Zone
from jfto_msgs_py.types import Array, Flags, Ints

# Beyond the margin: what plan files round, and what corners are computed off.
SPARE_M = 0.05
# Circles become polygons outside of them; sharper corners than a right angle are cut.
CIRCLE_CORNERS, MITRE = 16, 1.5
# So far inside its outline a zone begins for lines, which may run along the outline.
_SKIN_M = 2e-3
# Outlines with more corners are replaced by coarser ones around them, in looking for corners only.
MOST_CORNERS = 250
# Pairs of different heights see different zones; beyond so many sets, all zones count.
_MOST_SETS = 8
_FAR_M = 1e6


@dataclass(frozen=True)
class Ways:
    """Ways round for pairs of nodes: `vias[first[k]:first[k + 1]]` (P, 2) lie between those of k.

    `closed` (K,) marks pairs between which there is no way at all.
    """

    first: Ints
    vias: Array
    closed: Flags


@dataclass
class FreeSpace:
    """A fence with everything grown by its margin and `allowance_m`, what corners may cut."""

    fence: Fence
    allowance_m: float = 0.0
    names: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        self._by = self.fence.margin_m + self.allowance_m + SPARE_M
        zones = self.fence.keep_out
        self._shapes = [_grown(zone, self._by) for zone in zones]
        self._low = np.array([_or(zone.bottom_m, -np.inf) - self._by for zone in zones])
        self._high = np.array([_or(zone.top_m, np.inf) + self._by for zone in zones])
        self.names = tuple(zone.name for zone in zones)
        parts = self.fence.keep_in
        if parts:
            inner = [
                shapely.Polygon(part.outer, part.holes).buffer(
                    -self._by, join_style="mitre", mitre_limit=MITRE
                )
                for part in parts
            ]
            whole = shapely.box(-_FAR_M, -_FAR_M, _FAR_M, _FAR_M)
            self._shapes.append(whole.difference(shapely.intersection_all(inner)))
            self._low, self._high = np.append(self._low, -np.inf), np.append(self._high, np.inf)
            self.names += ("fence.keep_in",)
        self._cores = [shape.buffer(-_SKIN_M, join_style="mitre") for shape in self._shapes]
        shapely.prepare(self._cores)

    def inside(self, places_m: Array) -> list[str]:
        """What each place (K, 3) lies in, or too near to: the zone's name, "" where it is free."""
        hits = self._hits(places_m)
        return [self.names[int(row.argmax())] if row.any() else "" for row in hits.T]

    def blocked(self, places_m: Array) -> Flags:
        """Whether each place (K, 3) lies in a zone, or too near to one."""
        return np.asarray(self._hits(places_m).any(axis=0))

    def _hits(self, places_m: Array) -> Flags:
        """Which places (K, 3) lie in each zone, (Z, K)."""
        east, north, z = places_m.T
        found = np.zeros((len(self._cores), len(places_m)), dtype=np.bool_)
        limits = zip(self._cores, self._low, self._high, strict=True)
        for row, (core, low, high) in zip(found, limits, strict=True):
            row[:] = shapely.intersects_xy(core, east, north) & (z > low) & (z < high)
        return found

    def crossed(self, begin_m: Array, end_m: Array) -> Flags:
        """Which straight legs (K, 3) to (K, 3) enter a zone, or leave what is to be kept in.

        A leg passes over or under a zone where all of it that lies within the outline does.
        """
        lines = shapely.linestrings(np.stack([begin_m[:, :2], end_m[:, :2]], axis=1))
        found = np.zeros(len(lines), dtype=np.bool_)
        for core, low, high in zip(self._cores, self._low, self._high, strict=True):
            hit = np.flatnonzero(shapely.intersects(core, lines) & ~found)
            if np.isfinite(low) or np.isfinite(high):
                bottom, top = _heights_within(core, lines[hit], begin_m[hit], end_m[hit])
                hit = hit[(bottom < high) & (top > low)]
            found[hit] = True
        return found

    def ways(self, nodes_m: Array, pairs: Ints, over: bool = False) -> Ways:
        """Shortest ways round for pairs (K, 2) of nodes (M, 3), at heights between the two's.

        With `over` both may lie above or below zones, which are left in plan view only where they
        are in none to begin with.
        """
        ends = nodes_m[pairs]
        low, high = ends[..., 2].min(axis=1), ends[..., 2].max(axis=1)
        seen = (self._low[None, :] < high[:, None]) & (self._high[None, :] > low[:, None])
        if over:
            within = np.array(
                [shapely.intersects_xy(core, *nodes_m[:, :2].T) for core in self._cores]
            ).T.reshape(len(nodes_m), len(self._cores))
            seen = ~within[pairs].any(axis=1)
        sets, which = np.unique(seen, axis=0, return_inverse=True)
        if len(sets) > _MOST_SETS:
            sets, which = np.ones((1, seen.shape[1]), dtype=np.bool_), np.zeros(len(pairs), int)
        lists: list[Array | None] = [None] * len(pairs)
        for number, chosen in enumerate(sets):
            mine = np.flatnonzero(which.ravel() == number)
            shapes = [s for s, one in zip(self._shapes, chosen, strict=True) if one]
            graph = _Graph(shapely.union_all(shapes)) if shapes else None
            found = (
                [np.zeros((0, 2))] * len(mine)
                if graph is None
                else graph.ways(nodes_m[:, :2], pairs[mine])
            )
            for k, way in zip(mine, found, strict=True):
                lists[k] = way
        closed = np.array([way is None for way in lists], dtype=np.bool_)
        vias = [np.zeros((0, 2)) if way is None else way for way in lists]
        first = np.concatenate([[0], np.cumsum([len(way) for way in vias])]).astype(np.int64)
        return Ways(first, np.concatenate([np.zeros((0, 2)), *vias]), closed)


class _Graph:
    """Who sees whom among the corners of a shape that must not be entered."""

    def __init__(self, shape: shapely.Geometry) -> None:
        self._core = shape.buffer(-_SKIN_M, join_style="mitre")
        shapely.prepare(self._core)
        self._corners = _corners(shape)
        a, b = np.triu_indices(len(self._corners), 1)
        apart = np.linalg.norm(self._corners[a] - self._corners[b], axis=1)
        sees = self._sees(self._corners[a], self._corners[b])
        dense = np.full((len(self._corners),) * 2, np.inf)
        dense[a[sees], b[sees]] = dense[b[sees], a[sees]] = apart[sees]
        self._far, self._before = dijkstra(dense, directed=False, return_predecessors=True)

    def _sees(self, begin: Array, end: Array) -> Flags:
        lines = shapely.linestrings(np.stack([begin, end], axis=1))
        return np.asarray(~shapely.intersects(self._core, lines))

    def ways(self, nodes: Array, pairs: Ints) -> list[Array | None]:
        """Corners (P, 2) on the shortest way of each pair, None where there is none."""
        used, place = np.unique(pairs, return_inverse=True)
        place = place.reshape(-1, 2)
        count = len(self._corners)
        found: list[Array | None] = [None] * len(pairs)
        straight = self._sees(nodes[pairs[:, 0]], nodes[pairs[:, 1]])
        if not count:
            return [np.zeros((0, 2)) if one else None for one in straight]
        near = np.repeat(nodes[used], count, axis=0)
        corners = np.tile(self._corners, (len(used), 1))
        reach = np.linalg.norm(near - corners, axis=1)
        reach[~self._sees(near, corners)] = np.inf
        reach = reach.reshape(len(used), count)
        for i in np.unique(place[:, 0]):
            mine = np.flatnonzero(place[:, 0] == i)
            through = reach[i][:, None] + self._far
            enter = through.argmin(axis=0)
            total = through[enter, np.arange(count)] + reach[place[mine, 1]]
            leave = total.argmin(axis=1)
            for k, out, length in zip(mine, leave, total.min(axis=1), strict=True):
                if straight[k]:
                    found[k] = np.zeros((0, 2))
                elif np.isfinite(length):
                    found[k] = self._corners[self._chain(int(enter[out]), int(out))]
        return found

    def _chain(self, enter: int, leave: int) -> list[int]:
        chain = [leave]
        while chain[-1] != enter:
            chain.append(int(self._before[enter, chain[-1]]))
        return chain[::-1]


def _grown(zone: Zone, by_m: float) -> shapely.Polygon:
    """A zone's outline grown; nothing nearer than `by_m` to it lies outside of the result."""
    if zone.radius_m > 0:
        turns = np.arange(CIRCLE_CORNERS) * 2 * np.pi / CIRCLE_CORNERS
        radius = (zone.radius_m + by_m) / np.cos(np.pi / CIRCLE_CORNERS)
        ring = np.array(zone.centre_m) + radius * np.column_stack([np.cos(turns), np.sin(turns)])
        return shapely.Polygon(ring)
    return shapely.Polygon(zone.outer).buffer(by_m, join_style="mitre", mitre_limit=MITRE)


def _corners(shape: shapely.Geometry) -> Array:
    """Corners (C, 2) that shortest ways round may turn at, of a coarser outline if many."""
    found = _turning(shape)
    coarse = 1.0
    while len(found) > MOST_CORNERS:
        found = _turning(shape.buffer(coarse, join_style="mitre").simplify(0.99 * coarse))
        coarse *= 2
    return found


def _turning(shape: shapely.Geometry) -> Array:
    found: list[Array] = [np.zeros((0, 2))]
    for part in shapely.get_parts(shapely.normalize(shape)):
        polygon = shapely.geometry.polygon.orient(part)
        for ring in (polygon.exterior, *polygon.interiors):
            corners = shapely.get_coordinates(ring)[:-1]
            came = corners - np.roll(corners, 1, axis=0)
            goes = np.roll(corners, -1, axis=0) - corners
            # With the shape on its left, an outline turns left where the shape sticks out.
            left = came[:, 0] * goes[:, 1] - came[:, 1] * goes[:, 0] > 1e-9
            found.append(corners[left & (np.abs(corners).max(axis=1) < _FAR_M)])
    return np.asarray(np.round(np.concatenate(found), 6), dtype=np.float64)


def _heights_within(
    core: shapely.Geometry, lines: Iterable[shapely.Geometry], begin_m: Array, end_m: Array
) -> tuple[Array, Array]:
    """Least and greatest height (K,) of legs where they lie within a shape."""
    bounds = shapely.bounds(shapely.intersection(core, np.asarray(lines, dtype=object)))
    step = end_m - begin_m
    axis = np.abs(step[:, :2]).argmax(axis=1)
    row = np.arange(len(step))
    size = step[row, axis]
    ends = np.stack([bounds[row, axis], bounds[row, axis + 2]])
    share = np.divide(
        ends - begin_m[row, axis], size, out=np.zeros_like(ends), where=np.abs(size) > 1e-9
    )
    # Straight up or down all of a leg lies within.
    share[1, np.abs(size) <= 1e-9] = 1.0
    heights = begin_m[:, 2] + np.clip(share, 0.0, 1.0) * step[:, 2]
    return heights.min(axis=0), heights.max(axis=0)


def _or(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value
