"""The warm start: raising the likelihood of the routes that the search found."""

from __future__ import annotations

import math
from dataclasses import replace

import torch
from torch import Tensor

from jfto_planner.policy.kernel.replay import fly_routes
from jfto_planner.policy.network.model import Policy
from jfto_planner.policy.problems import Problems
from jfto_planner.policy.training.config import Stage

# Share of a stage's steps after which all its shards are in use; until then their number grows, so
# that they can be made beside the training.
GROWTH = 0.9
# Lateness, in units of extent over speed, that single precision alone can cause.
ROUNDING = 1e-5


def ready_shards(stage: Stage, within: int) -> int:
    """How many shards the stage's step of a number may draw from."""
    share = (within + 1) / (GROWTH * stage.steps)
    return min(stage.shards, math.ceil(stage.shards * share))


def imitate(
    policy: Policy, batch: Problems[Tensor], routes: Tensor
) -> tuple[Tensor, dict[str, float]]:
    """Mean negative log likelihood per choice of given routes (B, A, L), and its log row.

    The UAVs choose in the order in which they are free, as in a rollout.
    """
    device = batch.waypoints.device
    flown, chosen = fly_routes(batch.numpy(), routes.numpy())
    seen, choices = flown.seen.tensors().to(device), torch.from_numpy(chosen).to(device)
    # The mask looks at the neighbour rule at other instants than the search does.
    allowed = seen.allowed.scatter(-1, choices.flatten(1)[..., None], True)
    seen = replace(seen, allowed=allowed)
    loss = -policy.log_likelihood(policy.encode(batch), seen, choices).mean() / choices.shape[-1]
    clean = (flown.misses == 0) & (flown.late <= ROUNDING)
    return loss, {
        "waypoints": batch.waypoints.shape[1],
        "uavs": batch.start_of.shape[1],
        "length": float(flown.length.mean()),
        "misses": float(flown.misses.mean()),
        "late": float(flown.late.mean()),
        "feasible": float(clean.mean()),
        "loss": float(loss.detach()),
    }
