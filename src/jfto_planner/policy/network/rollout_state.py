"""Where every UAV of B × P rollouts is, and what has been visited, as tensors."""

from __future__ import annotations

import torch
from torch import Tensor

from jfto_planner.policy.features import LEAST_LENGTH
from jfto_planner.policy.problems import Problems


class RolloutState:
    """Legs `origin` to `target` (B, P, A, 3) from `depart` to `arrive` (B, P, A), in extents.

    `done` (B, P, A) says who has stopped for good, `visited` (B, P, W) what needs no visit, `node`
    (B, P, A) where each UAV stands or flies to: a start, or behind these a waypoint.
    """

    def __init__(self, batch: Problems[Tensor], rollouts: int) -> None:
        self.batch = batch
        start = batch.starts.gather(1, batch.start_of[..., None].expand(-1, -1, 3))
        start = start[:, None].expand(-1, rollouts, -1, -1)
        self.origin = start.clone()
        self.target = start.clone()
        self.depart = start.new_zeros(start.shape[:-1])
        self.arrive = start.new_zeros(start.shape[:-1])
        self.done = ~batch.uav_valid[:, None].expand(-1, rollouts, -1)
        self.visited = ~batch.waypoint_valid[:, None].expand(-1, rollouts, -1)
        self.node = batch.start_of[:, None].expand(-1, rollouts, -1).clone()

    def positions(self, time: Tensor) -> Tensor:
        """Where every UAV is (B, P, A, 3) at a time (B, P)."""
        span = (self.arrive - self.depart).clamp(min=LEAST_LENGTH)
        share = ((time[..., None] - self.depart) / span).clamp(0, 1)
        return self.origin + (self.target - self.origin) * share[..., None]

    def move(
        self,
        active: Tensor,
        moves: Tensor,
        now: Tensor,
        arrival: Tensor,
        there: Tensor,
        waypoint: Tensor,
    ) -> None:
        """Send UAV `active` (B, P, 1) on its leg to `there` (B, P, 3), or let it hold for good."""
        vector = active[..., None].expand(-1, -1, 1, 3)
        here = self.target.gather(2, vector)
        self.origin = self.origin.scatter(2, vector, here)
        goal = torch.where(moves[..., None, None], there[..., None, :], here)
        self.target = self.target.scatter(2, vector, goal)
        self.depart = self.depart.scatter(2, active, now[..., None])
        until = torch.where(moves, arrival, now)
        self.arrive = self.arrive.scatter(2, active, until[..., None])
        was_done = self.done.gather(2, active).squeeze(-1)
        self.done = self.done.scatter(2, active, (was_done | ~moves)[..., None])
        known = self.visited.gather(2, waypoint[..., None]).squeeze(-1)
        self.visited = self.visited.scatter(2, waypoint[..., None], (known | moves)[..., None])
        old = self.node.gather(2, active).squeeze(-1)
        new = torch.where(moves, waypoint + self.batch.starts.shape[1], old)
        self.node = self.node.scatter(2, active, new[..., None])


def row_of(per_uav: Tensor, active: Tensor) -> Tensor:
    """Row of the active UAV: (B, P, A, K) and (B, P) give (B, P, K)."""
    index = active[..., None, None].expand(-1, -1, 1, per_uav.shape[-1])
    return per_uav.gather(2, index).squeeze(2)
