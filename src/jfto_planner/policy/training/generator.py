"""Random instances to learn from: uniform, Gaussian, gridded and on real terrain."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import torch
from torch import Tensor

from jfto_planner.policy.features import TOUR
from jfto_planner.policy.problems import Problems
from jfto_world.terrain.sample_tile import jacksboro

# Streams of random numbers that must not meet.
TRAINING, EVALUATION, TEACHER, HELD_OUT = range(4)
UNIFORM, GAUSSIAN, GRID, DEM = range(4)
KINDS = ("uniform", "gaussian", "grid", "dem")
# Metres per degree of latitude, for the spacing of the built-in terrain's cells.
DEGREE_M = 111_195.0


def generator_of(seed: int, stream: int, number: int, rank: int = 0) -> torch.Generator:
    """Generator of one step, evaluation or shard of one worker: a function of these alone.

    So a run that is resumed draws what the run that was killed would have drawn.
    """
    mixed = ((seed * 4 + stream) * 1_000_003 + number) * 64 + rank
    return torch.Generator().manual_seed(mixed % 2**63)


def between(limits: tuple[int, int], generator: torch.Generator) -> int:
    """Whole number drawn from a closed range."""
    return int(torch.randint(limits[0], limits[1] + 1, (1,), generator=generator))


@dataclass(frozen=True)
class SceneRanges:
    """Ranges that instances are drawn from.

    `extent_m` is the longer side of the scene and `aspect` the shorter one's share of it;
    `reach_share` the radio range at full power as a share of the extent; `tightness` how many
    times the expected share of a short tour fits into T_a,max.
    """

    extent_m: tuple[float, float] = (400.0, 2500.0)
    aspect: tuple[float, float] = (0.5, 1.0)
    speed_mps: tuple[float, float] = (8.0, 12.0)
    reach_share: tuple[float, float] = (0.7, 1.4)
    tightness: tuple[float, float] = (1.2, 3.0)
    starts: tuple[int, int] = (1, 4)
    k_min: int = 2
    spread: float = 0.15  # how much UAVs of one fleet differ


def draw(
    generator: torch.Generator, count: int, waypoints: int, uavs: int, ranges: SceneRanges
) -> Problems[Tensor]:
    """A batch of `count` instances of one size, each of a kind of its own."""

    def uniform(*shape: int, low: float = 0.0, high: float = 1.0) -> Tensor:
        return low + (high - low) * torch.rand(*shape, generator=generator)

    kinds = torch.randint(len(KINDS), (count,), generator=generator)
    extent = uniform(count, low=ranges.extent_m[0], high=ranges.extent_m[1])
    aspect = uniform(count, 1, low=ranges.aspect[0], high=ranges.aspect[1])
    flat = _flat_points(generator, kinds, count, waypoints)
    flat = torch.stack((flat[..., 0], flat[..., 1] * aspect), dim=-1)
    height = _heights(generator, flat, kinds, extent)
    points = torch.cat([flat, height[..., None]], dim=-1)
    number = int(torch.randint(ranges.starts[0], ranges.starts[1] + 1, (1,), generator=generator))
    start_of = torch.arange(uavs).remainder(number).expand(count, -1).contiguous()
    reach = uniform(count, 1, low=ranges.reach_share[0], high=ranges.reach_share[1])
    reach = reach * uniform(count, uavs, low=1 - ranges.spread, high=1.0)
    speed = uniform(count, uavs, low=1 - ranges.spread / 2, high=1 + ranges.spread / 2)
    share = TOUR * math.sqrt(waypoints) / uavs
    tight = uniform(count, 1, low=ranges.tightness[0], high=ranges.tightness[1])
    t_max = (tight * share + 0.5) * uniform(count, uavs, low=1 - ranges.spread, high=1.0)
    starts = _starts(generator, points, number, reach.amin(1))
    climb = uniform(count, 1, low=0.4, high=0.8).expand(-1, uavs).contiguous()
    return Problems(
        waypoints=points,
        starts=starts,
        start_of=start_of,
        speed=speed,
        climb=climb,
        descent=climb * 0.8,
        t_max=t_max,
        reach=reach,
        k_min=torch.full((count,), min(ranges.k_min, uavs - 1)),
        waypoint_valid=torch.ones(count, waypoints, dtype=torch.bool),
        uav_valid=torch.ones(count, uavs, dtype=torch.bool),
        extent_m=extent.double(),
    )


def _flat_points(generator: torch.Generator, kinds: Tensor, count: int, waypoints: int) -> Tensor:
    uniform = torch.rand(count, waypoints, 2, generator=generator)
    gaussian = 0.5 + 0.18 * torch.randn(count, waypoints, 2, generator=generator)
    columns = max(1, round(math.sqrt(waypoints)))
    rows = math.ceil(waypoints / columns)
    cell = torch.randperm(columns * rows, generator=generator)[:waypoints]
    regular = torch.stack([(cell % columns + 0.5) / columns, (cell // columns + 0.5) / rows], -1)
    jitter = torch.rand(count, 1, 1, generator=generator) * 0.25 / columns
    gridded = regular + jitter * torch.randn(count, waypoints, 2, generator=generator)
    kind = kinds[:, None, None]
    flat = torch.where(kind == UNIFORM, uniform, torch.where(kind == GAUSSIAN, gaussian, gridded))
    return flat.clamp(0, 1)


def _heights(generator: torch.Generator, flat: Tensor, kinds: Tensor, extent_m: Tensor) -> Tensor:
    """Heights in extents: the built-in elevation model's at a random place and heading for "dem",
    a few smooth hills for "grid", nearly level for the others.
    """
    count = flat.shape[0]
    centre = torch.rand(count, 1, 4, 2, generator=generator)
    tall = 0.25 * torch.rand(count, 1, 4, generator=generator)
    wide = 0.1 + 0.3 * torch.rand(count, 1, 4, generator=generator)
    away = (flat[:, :, None] - centre).square().sum(-1) / wide.square()
    hills = (tall * torch.exp(-away / 2)).sum(-1)
    terrain, cell_m = _terrain()
    place = torch.rand(count, 1, 2, generator=generator)
    turn = 2 * math.pi * torch.rand(count, 1, generator=generator)
    x, y = (flat - 0.5).unbind(-1)
    turned = torch.stack((x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos()), dim=-1)
    cells = turned * (extent_m[:, None, None] / cell_m)
    # So far from the edges that a scene of any heading lies within the tile.
    margin = 0.71 * extent_m[:, None, None] / cell_m
    room = torch.tensor(terrain.shape).flip(0) - 2 - 2 * margin
    heights = _bilinear(terrain, cells + margin + place * room) / extent_m[:, None]
    shaped = torch.where((kinds == GRID)[:, None], hills, 0.1 * hills)
    shaped = torch.where((kinds == DEM)[:, None], heights, shaped)
    return shaped - shaped.amin(1, keepdim=True)


@functools.cache
def _terrain() -> tuple[Tensor, Tensor]:
    """Heights (rows, columns) of the built-in elevation model and its cell's (x, y) sides, m."""
    tile = jacksboro()
    rows, columns = tile.shape
    heights = torch.as_tensor(tile.read(0, rows, 0, columns), dtype=torch.float32)
    latitude = math.radians(tile.transform.f)
    sides = (abs(tile.transform.a) * math.cos(latitude), abs(tile.transform.e))
    return heights, torch.tensor(sides) * DEGREE_M


def _bilinear(raster: Tensor, place: Tensor) -> Tensor:
    """Values of a raster at (column, row) places (..., 2)."""
    corner = place.floor().long()
    x, y = (place - corner).unbind(-1)
    column, row = corner.unbind(-1)
    top = raster[row, column] * (1 - x) + raster[row, column + 1] * x
    low = raster[row + 1, column] * (1 - x) + raster[row + 1, column + 1] * x
    return top * (1 - y) + low * y


def _starts(generator: torch.Generator, points: Tensor, number: int, least_reach: Tensor) -> Tensor:
    """Start points drawn toward the middle until all lie within each other's radio range."""
    count = points.shape[0]
    centre = points[..., :2].mean(1, keepdim=True)
    spot = torch.rand(count, number, 2, generator=generator) * points[..., :2].amax(1)[:, None]
    away = spot - centre
    widest = torch.cdist(spot, spot).amax((1, 2)).clamp(min=1e-6)
    shrink = (0.9 * least_reach / widest).clamp(max=1.0)
    flat = centre + away * shrink[:, None, None]
    low = points[..., 2].amin(1)[:, None, None].expand(-1, number, 1)
    return torch.cat([flat, low], dim=-1)
