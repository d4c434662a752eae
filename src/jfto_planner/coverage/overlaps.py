"""How far neighbouring photos overlap, pair by pair, from their footprints on the ground.

Knows nothing of how the photos came about: neighbours are told by where the photos look.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from jfto_msgs_py.records.plan import Waypoint
from jfto_msgs_py.types import Array, Flags
from jfto_planner.coverage.camera import Camera, view_axes
from jfto_world.terrain import Dem

# Lines across an image and points on each, at which it is asked whether the other photo shows them.
_LINES, _POINTS = 5, 41
# One point of a line: what an overlap may fall short by without being called so.
TOLERANCE = 1 / (_POINTS - 1)
# A neighbour's middle lies so near in image widths or heights, and so little to the side.
_NEAR, _BESIDE = 1.5, 0.5


@dataclass(frozen=True)
class PairOverlaps:
    """Overlaps of all pairs in one direction; the shares are NaN where there is no pair.

    `below` counts pairs of less than `wished`, by more than `TOLERANCE`, and `worst` names the
    waypoints of the least.
    """

    wished: float
    pairs: int
    least: float
    p05: float
    below: int
    worst: tuple[int, int] | None


@dataclass(frozen=True)
class Overlaps:
    """σ_h, across (along the image's long side), and σ_v, along its height, as they came out."""

    across: PairOverlaps
    along: PairOverlaps

    @property
    def below(self) -> int:
        """Pairs of both directions that fall short."""
        return self.across.below + self.along.below


def measure_overlaps(
    waypoints: Sequence[Waypoint], dem: Dem, camera: Camera, wished: tuple[float, float]
) -> Overlaps:
    """Overlap of every photo with its neighbours to all four sides.

    Neighbours are the nearest photos whose middle lies to a side, no farther than 1.5 images, with
    ground of the area halfway between and no third photo's middle in the circle of which theirs
    span the diameter. The overlap of a pair is the share of an image's lines that
    the other one shows too, the lesser of both ways: ray casting onto the ground itself.

    Parameters
    ----------
    waypoints
        Where photos are taken, with yaw and pitch.
    dem
        The ground and its area.
    camera
        Sensor and lens.
    wished
        σ_h and σ_v, against which pairs are counted.

    Returns
    -------
    Overlaps
        Least, 5th percentile, and how many pairs fall short.
    """
    photos = [photo for w in waypoints if (photo := _Photo.of(w, dem, camera)) is not None]
    found: tuple[dict[tuple[int, int], float], ...] = ({}, {})
    for direction, first, second in _neighbours(photos, dem):
        pair = (min(first, second), max(first, second))
        if pair not in found[direction]:
            one, other = photos[first], photos[second]
            found[direction][pair] = min(
                one.share_seen_by(other, direction), other.share_seen_by(one, direction)
            )
    ids = [photo.waypoint.id for photo in photos]
    return Overlaps(*(_summary(f, ids, wish) for f, wish in zip(found, wished, strict=True)))


def _summary(found: dict[tuple[int, int], float], ids: list[int], wished: float) -> PairOverlaps:
    if not found:
        return PairOverlaps(wished, 0, np.nan, np.nan, 0, None)
    shares = np.array(list(found.values()))
    first, second = min(found, key=lambda pair: (found[pair], pair))
    return PairOverlaps(
        wished,
        len(shares),
        float(shares.min()),
        float(np.quantile(shares, 0.05)),
        int((shares < wished - TOLERANCE - 1e-9).sum()),
        (ids[first], ids[second]),
    )


@dataclass(frozen=True, eq=False)
class _Photo:
    """A photo, where its middle looks, and its lines on the ground: (2, lines, points, 3).

    Lines of the first kind run along the image's width, of the second along its height; NaN where
    a ray meets no ground.
    """

    waypoint: Waypoint
    dem: Dem
    axes: tuple[Array, Array, Array]
    half: tuple[float, float]
    middle_m: Array
    size_m: tuple[float, float]
    lines_m: Array

    @classmethod
    def of(cls, waypoint: Waypoint, dem: Dem, camera: Camera) -> _Photo | None:
        """The photo of a waypoint, None where it takes none or looks at no ground."""
        if not waypoint.photo:
            return None
        look, right, up = view_axes(waypoint)
        half = (camera.half_width, camera.half_height)
        side, fine = np.linspace(-0.8, 0.8, _LINES), np.linspace(-1.0, 1.0, _POINTS)
        fine_grid, side_grid = np.meshgrid(fine, side)
        across = np.stack([np.stack([fine_grid, side_grid]), np.stack([side_grid, fine_grid])])
        rays = (
            look
            + half[0] * across[:, 0, ..., None] * right
            + half[1] * across[:, 1, ..., None] * up
        ).reshape(-1, 3)
        start = np.array(waypoint.position_m)
        reach = dem.first_hit(start, np.concatenate([look[None], rays]))
        if not np.isfinite(reach[0]):
            return None
        lengths = np.linalg.norm(rays, axis=-1, keepdims=True)
        with np.errstate(invalid="ignore"):
            hits = start + reach[1:, None] * rays / lengths
        hits[~np.isfinite(reach[1:])] = np.nan
        depth = float(reach[0])
        return cls(
            waypoint,
            dem,
            (look, right, up),
            half,
            start + depth * look,
            (2 * half[0] * depth, 2 * half[1] * depth),
            hits.reshape(2, _LINES, _POINTS, 3),
        )

    def offset(self, point_m: Array) -> Array:
        """Where points (..., 3) lie from the middle, in widths to the right and heights up."""
        away = point_m - self.middle_m
        _, right, up = self.axes
        return np.stack([away @ right / self.size_m[0], away @ up / self.size_m[1]], axis=-1)

    def shows(self, points_m: Array) -> Flags:
        """Whether points of the ground (K, 3) are in the frame and not hidden."""
        look, right, up = self.axes
        position = np.array(self.waypoint.position_m)
        sight = points_m - position
        depth = sight @ look
        slack = 1 + 1e-9
        seen: Flags = (
            (depth > 0)
            & (np.abs(sight @ right) <= self.half[0] * depth * slack)
            & (np.abs(sight @ up) <= self.half[1] * depth * slack)
        )
        if seen.any():
            seen[seen] = self.dem.sees(position, points_m[seen])
        return seen

    def share_seen_by(self, other: _Photo, direction: int) -> float:
        """Mean share of the lines that `other` shows, over those of which it shows any."""
        lines = self.lines_m[direction]
        known = np.isfinite(lines[..., 0])
        seen = np.zeros(known.shape, dtype=bool)
        seen[known] = other.shows(lines[known])
        crossed = seen.any(axis=1)
        if not crossed.any():
            return 0.0
        return float((seen[crossed].sum(axis=1) / known[crossed].sum(axis=1)).mean())


def _neighbours(photos: list[_Photo], dem: Dem) -> Iterator[tuple[int, int, int]]:
    """Direction (0 across, 1 along) and indices of each photo and its nearest to each side."""
    if not photos:
        return
    middles = np.array([photo.middle_m for photo in photos])
    tree = cKDTree(middles)
    for index, photo in enumerate(photos):
        near = np.array(tree.query_ball_point(photo.middle_m, 2 * max(photo.size_m)))
        near = near[near != index]
        if not near.size:
            continue
        offset = photo.offset(middles[near])
        halfway = (middles[near] + photo.middle_m) / 2
        joined = dem.in_area(halfway[:, 0], halfway[:, 1])
        distance = np.hypot(*offset.T)
        for direction in (0, 1):
            forward, aside = offset[:, direction], np.abs(offset[:, 1 - direction])
            for sign in (1, -1):
                there = sign * forward
                fits = (there > aside) & (there <= _NEAR) & (aside <= _BESIDE) & joined
                if not fits.any():
                    continue
                best = int(near[fits][np.argmin(distance[fits])])
                gap_m = float(np.linalg.norm(middles[best] - photo.middle_m))
                between = tree.query_ball_point(
                    (middles[best] + photo.middle_m) / 2, gap_m / 2 * (1 - 1e-6)
                )
                if not between:
                    yield direction, index, best
