"""Random instances to learn from: uniform, Gaussian, gridded and terrain-like scenes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from jfto_planner.policy.instance import InstanceBatch

KINDS = ("uniform", "gaussian", "grid", "terrain")


@dataclass(frozen=True)
class SceneRanges:
    """Ranges that instances are drawn from.

    `extent_m` is the side of the scene; `reach_share` the radio range at full power as a share of
    it; `tightness` how many times the expected share of a short tour fits into T_a,max.
    """

    extent_m: tuple[float, float] = (400.0, 2500.0)
    speed_mps: tuple[float, float] = (8.0, 12.0)
    reach_share: tuple[float, float] = (0.7, 1.2)
    tightness: tuple[float, float] = (1.6, 3.2)
    starts: tuple[int, int] = (1, 4)
    k_min: int = 2
    spread: float = 0.15  # how much UAVs of one fleet differ


def draw(
    generator: torch.Generator, count: int, waypoints: int, uavs: int, ranges: SceneRanges
) -> InstanceBatch:
    """A batch of `count` instances of one size, each of a kind of its own."""

    def uniform(*shape: int, low: float = 0.0, high: float = 1.0) -> Tensor:
        return low + (high - low) * torch.rand(*shape, generator=generator)

    kinds = torch.randint(len(KINDS), (count,), generator=generator)
    flat = _flat_points(generator, kinds, count, waypoints)
    extent = uniform(count, low=ranges.extent_m[0], high=ranges.extent_m[1])
    height = _heights(generator, flat, kinds)
    points = torch.cat([flat, height[..., None]], dim=-1)
    number = int(torch.randint(ranges.starts[0], ranges.starts[1] + 1, (1,), generator=generator))
    start_of = torch.arange(uavs).remainder(number).expand(count, -1).contiguous()
    reach = uniform(count, 1, low=ranges.reach_share[0], high=ranges.reach_share[1])
    reach = reach * uniform(count, uavs, low=1 - ranges.spread, high=1.0)
    speed = uniform(count, uavs, low=1 - ranges.spread / 2, high=1 + ranges.spread / 2)
    share = 0.7124 * math.sqrt(waypoints) / uavs
    tight = uniform(count, 1, low=ranges.tightness[0], high=ranges.tightness[1])
    t_max = (tight * share + 0.5) * uniform(count, uavs, low=1 - ranges.spread, high=1.0)
    starts = _starts(generator, points, number, reach.amin(1))
    climb = uniform(count, 1, low=0.25, high=0.5).expand(-1, uavs).contiguous()
    return InstanceBatch(
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
    jitter = 0.15 / columns * torch.randn(count, waypoints, 2, generator=generator)
    gridded = regular + jitter
    kind = kinds[:, None, None]
    flat = torch.where(kind == 0, uniform, torch.where(kind == 1, gaussian, gridded))
    return flat.clamp(0, 1)


def _heights(generator: torch.Generator, flat: Tensor, kinds: Tensor) -> Tensor:
    """Heights of a few smooth hills for terrain-like kinds, nearly level for the others."""
    count = flat.shape[0]
    centre = torch.rand(count, 1, 4, 2, generator=generator)
    tall = 0.25 * torch.rand(count, 1, 4, generator=generator)
    wide = 0.1 + 0.3 * torch.rand(count, 1, 4, generator=generator)
    away = (flat[:, :, None] - centre).square().sum(-1) / wide.square()
    hills = (tall * torch.exp(-away / 2)).sum(-1)
    return torch.where((kinds >= 2)[:, None], hills, 0.1 * hills)


def _starts(generator: torch.Generator, points: Tensor, number: int, least_reach: Tensor) -> Tensor:
    """Start points drawn toward the middle until all lie within each other's radio range."""
    count = points.shape[0]
    centre = points[..., :2].mean(1, keepdim=True)
    spot = torch.rand(count, number, 2, generator=generator)
    away = spot - centre
    widest = torch.cdist(spot, spot).amax((1, 2)).clamp(min=1e-6)
    shrink = (0.9 * least_reach / widest).clamp(max=1.0)
    flat = centre + away * shrink[:, None, None]
    low = points[..., 2].amin(1)[:, None, None].expand(-1, number, 1)
    return torch.cat([flat, low], dim=-1)
