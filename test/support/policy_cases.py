"""Small problems that the policy tests share."""

from __future__ import annotations

import torch

from jfto_planner.policy.generator import SceneRanges, draw
from jfto_planner.policy.instance import InstanceBatch
from jfto_planner.policy.shape import PolicyShape

SMALL = PolicyShape(width=16, heads=4, layers=2, hidden=32)


def instances(count: int, waypoints: int, uavs: int, *, seed: int = 0, k_min: int = 1):
    """Random problems of one size."""
    generator = torch.Generator().manual_seed(seed)
    return draw(generator, count, waypoints, uavs, SceneRanges(k_min=k_min))


def line_of_three(*, reach: float, t_max: float = 100.0, k_min: int = 1) -> InstanceBatch:
    """Two UAVs at x = 0 and waypoints at x = 0.1, 0.2 and 0.9, all on a line, speed 1."""
    return InstanceBatch(
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
