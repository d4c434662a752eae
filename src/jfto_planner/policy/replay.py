"""From the compiled rollouts' records to the tensors that the network learns from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from jfto_planner.policy.environment import Observation
from jfto_planner.policy.instance import InstanceBatch
from jfto_planner.policy.kernel import episode
from jfto_planner.policy.kernel.arrays import View, empty_fleet, empty_view


@dataclass(frozen=True)
class Replayed:
    """Given routes as an episode: what was seen and chosen (B, 1, T), and the outcome (B, 1)."""

    seen: Observation
    choices: Tensor
    length: Tensor
    misses: Tensor
    late: Tensor


def replay(batch: InstanceBatch, routes: Tensor) -> Replayed:
    """Fly given routes (B, A, L), each ended by W or by L; UAVs choose as they become free."""
    scene = batch.numpy().scene()
    uavs, waypoints = scene.speed.shape[1], scene.waypoints.shape[1]
    fleet, view = empty_fleet(scene, 1), empty_view(scene, 1, uavs + waypoints)
    choices = np.zeros((len(routes), 1, uavs + waypoints), np.int64)
    room = np.zeros((uavs, 3)), np.zeros(uavs, np.int64)
    episode.replay(scene, fleet, view, routes.numpy(), choices, *room)
    outcome = (choices, fleet.length, fleet.misses, fleet.late)
    return Replayed(recorded(view), *(torch.from_numpy(column) for column in outcome))


def recorded(view: View) -> Observation:
    """All steps of a view, as those of P × T rollouts."""

    def tensor(array: np.ndarray) -> Tensor:
        return torch.from_numpy(array).flatten(1, 2)

    return Observation(
        active=tensor(view.active),
        allowed=tensor(view.allowed),
        keeps_rule=tensor(view.keeps_rule),
        visited=tensor(view.visited),
        node=tensor(view.node),
        state=tensor(view.state),
        pair=tensor(view.pair),
    )
