"""Small problems that the policy tests share."""

from __future__ import annotations

from dataclasses import fields

import torch
from torch import Tensor

from jfto_planner.policy.compiled_policy import PolicyShape
from jfto_planner.policy.problems import Problems
from jfto_planner.policy.training.generator import SceneRanges, draw

SMALL = PolicyShape(width=16, heads=4, layers=2, hidden=32)


def instances(count: int, waypoints: int, uavs: int, *, seed: int = 0, k_min: int = 1):
    """Random problems of one size."""
    generator = torch.Generator().manual_seed(seed)
    return draw(generator, count, waypoints, uavs, SceneRanges(k_min=k_min))


def line_of_three(*, reach: float, t_max: float = 100.0, k_min: int = 1) -> Problems[Tensor]:
    """Two UAVs at x = 0 and waypoints at x = 0.1, 0.2 and 0.9, all on a line, speed 1."""
    return Problems(
        waypoints=torch.tensor([[[0.1, 0, 0], [0.2, 0, 0], [0.9, 0, 0]]]),
        starts=torch.zeros(1, 1, 3),
        start_of=torch.zeros(1, 2, dtype=torch.long),
        speed=torch.ones(1, 2),
        climb=torch.ones(1, 2),
        descent=torch.ones(1, 2),
        t_max=torch.full((1, 2), t_max),
        reach=torch.full((1, 2), reach),
        k_min=torch.tensor([k_min]),
        waypoint_valid=torch.ones(1, 3, dtype=torch.bool),
        uav_valid=torch.ones(1, 2, dtype=torch.bool),
        extent_m=torch.ones(1, dtype=torch.float64),
    )


# A padded UAV must not divide by zero: its speeds are 1. Nor may it be the neighbour of one at the
# same point: its reach is negative.
FILLERS = {"speed": 1.0, "climb": 1.0, "descent": 1.0, "t_max": 1.0, "reach": -1.0}


def stack(batches: list[Problems[Tensor]]) -> Problems[Tensor]:
    """Batches of any sizes as one, padded with absent waypoints, starts and UAVs."""
    columns = {}
    for item in fields(Problems):
        parts = [getattr(batch, item.name) for batch in batches]
        if parts[0].ndim > 1:
            width = max(part.shape[1] for part in parts)
            parts = [_padded(part, width, FILLERS.get(item.name, 0.0)) for part in parts]
        columns[item.name] = torch.cat(parts)
    return Problems(**columns)


def _padded(tensor: Tensor, width: int, filler: float) -> Tensor:
    shape = list(tensor.shape)
    shape[1] = width - shape[1]
    return torch.cat([tensor, tensor.new_full(shape, filler)], dim=1)
