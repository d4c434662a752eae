"""Random instances."""

from __future__ import annotations

import torch

from jfto_planner.policy.training.generator import SceneRanges, draw
from support.policy_cases import instances


def test_the_same_seed_draws_the_same_instances() -> None:
    """Everything random comes from the generator."""
    first, second, other = (instances(20, 12, 5, seed=seed) for seed in (3, 3, 4))
    assert torch.equal(first.waypoints, second.waypoints)
    assert not torch.equal(first.waypoints, other.waypoints)


def test_fleets_start_within_radio_range() -> None:
    """Every pair of starting points lies within the least reach, or no plan could be sound."""
    batch = instances(50, 12, 6, seed=1)
    gaps = torch.cdist(batch.starts[..., :2], batch.starts[..., :2]).amax((1, 2))
    assert (gaps <= batch.reach.amin(1)).all()


def test_some_scenes_lie_on_real_terrain() -> None:
    """The built-in elevation model and hills give about half of the scenes tens of metres of relief
    and more; heights start at 0.
    """
    batch = draw(torch.Generator().manual_seed(0), 200, 40, 4, SceneRanges())
    relief_m = batch.waypoints[..., 2].amax(1) * batch.extent_m
    assert (batch.waypoints[..., 2].amin(1) == 0).all()
    assert 0.2 < float((relief_m > 60).float().mean()) < 0.8
