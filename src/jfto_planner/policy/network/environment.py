"""Building the routes of a whole fleet step by step, many problems and rollouts at once.

In tensors, for training on any device; kernel/observe.py is the compiled twin for CPUs.

At each step the UAV that is free first chooses its next waypoint, or stops for good. So when it
chooses, what all others do until then is already decided, and the neighbour rule (P1kmin) can be
checked for everyone.
"""

from __future__ import annotations

import torch
from torch import Tensor

from jfto_planner.policy.features import CHECKED_FRACTIONS, LEAST_LENGTH
from jfto_planner.policy.network.describe import describe_pairs, describe_state
from jfto_planner.policy.network.rollout_state import RolloutState, row_of
from jfto_planner.policy.observation import Observation
from jfto_planner.policy.problems import Problems


class Episode(RolloutState):
    """What may be chosen in B × P rollouts and what it costs; `length` (B, P) in extents.

    `misses` (B, P) counts choices that broke the neighbour rule for want of a better one, `late`
    (B, P) sums the time by which UAVs overran T_a,max. Rollouts end after A + W steps.
    """

    def __init__(self, batch: Problems[Tensor], rollouts: int) -> None:
        super().__init__(batch, rollouts)
        shape = (batch.size, rollouts)
        self.length = batch.starts.new_zeros(shape)
        self.misses = batch.starts.new_zeros(shape)
        self.late = batch.starts.new_zeros(shape)
        reach = torch.minimum(batch.reach[:, :, None], batch.reach[:, None, :])
        self._pair_reach = reach[:, None]
        # Padding has no reach, so it is no one's neighbour; it needs none itself.
        self._need = (batch.k_min[:, None] * batch.uav_valid)[:, None]
        self._seen: Observation[Tensor] | None = None

    @property
    def steps(self) -> int:
        """Steps until every rollout has ended."""
        return self.visited.shape[-1] + self.done.shape[-1]

    def observe(self) -> Observation[Tensor]:
        """What the UAV that is free first may choose."""
        clock = torch.where(self.done, torch.inf, self.arrive)
        # Rollouts that ended early keep stopping their first UAV; that changes nothing.
        now, active = clock.min(-1)
        now = torch.where(torch.isfinite(now), now, 0.0)
        here = row_of(self.target, active)
        others_free = clock.scatter(-1, active[..., None], torch.inf).amin(-1)
        step = self.batch.waypoints[:, None] - here[..., None, :]
        duration = self._leg_time(step, active)
        distance = step.norm(dim=-1)
        keeps_rule, degree = self._keeps_rule(active, now, others_free, here, step, duration)
        allowed = self._allowed(active, now, duration, others_free, keeps_rule)
        pair, drawn = describe_pairs(self, active, now, duration, distance)
        state = describe_state(self, active, now, others_free, degree, drawn)
        self._seen = Observation(
            active, now, allowed, keeps_rule, self.visited, duration, self.node, state, pair
        )
        return self._seen

    def step(self, choice: Tensor) -> None:
        """Carry out one choice (B, P) of the last observation: a waypoint, or W to stop."""
        seen = self._seen
        assert seen is not None, "a choice is made of what has been observed"
        count = self.visited.shape[-1]
        moves = choice < count
        waypoint = choice.clamp(max=count - 1)
        active = seen.active[..., None]
        duration = seen.duration.gather(-1, waypoint[..., None]).squeeze(-1)
        ended = self.done.all(-1)
        arrival = seen.now + duration
        t_max = self.batch.t_max[:, None].expand_as(self.arrive).gather(-1, active).squeeze(-1)
        broke = ~seen.keeps_rule.gather(-1, choice[..., None]).squeeze(-1) & ~ended
        self.misses = self.misses + broke
        overrun = (arrival - t_max).clamp(min=0) - (seen.now - t_max).clamp(min=0)
        self.late = self.late + torch.where(moves, overrun, 0.0)
        here = row_of(self.target, seen.active)
        there = self.batch.waypoints[:, None].expand(-1, choice.shape[1], -1, -1)
        there = there.gather(2, waypoint[..., None, None].expand(-1, -1, 1, 3)).squeeze(2)
        self.length = self.length + torch.where(moves, (there - here).norm(dim=-1), 0.0)
        self.move(active, moves, seen.now, arrival, there, waypoint)

    def _leg_time(self, step: Tensor, active: Tensor) -> Tensor:
        """Time of the direct legs (B, P, W) of the active UAV, as in ConstantSpeed."""

        def of_active(values: Tensor) -> Tensor:
            wide = values[:, None].expand(-1, active.shape[1], -1)
            return wide.gather(-1, active[..., None])

        level = step[..., :2].norm(dim=-1) / of_active(self.batch.speed)
        rise = step[..., 2]
        climb, descent = of_active(self.batch.climb), of_active(self.batch.descent)
        return torch.maximum(level, torch.where(rise > 0, rise / climb, -rise / descent))

    def _keeps_rule(
        self,
        active: Tensor,
        now: Tensor,
        others_free: Tensor,
        here: Tensor,
        step: Tensor,
        duration: Tensor,
    ) -> tuple[Tensor, Tensor]:
        """Choices (B, P, W + 1) that keep K_min neighbours for everyone while they are decided.

        Also the degrees (B, P, A) at the end of that time if the active UAV stays.
        """
        window = (others_free - now).clamp(min=0)
        window = torch.where(torch.isfinite(window), window, 0.0)
        alone = ~torch.isfinite(others_free)
        flown = torch.where(alone[..., None], duration, torch.minimum(window[..., None], duration))
        share = flown / duration.clamp(min=LEAST_LENGTH)
        is_active = torch.zeros_like(self.done).scatter(-1, active[..., None], True)
        reach = self._pair_reach.expand(-1, active.shape[1], -1, -1)
        own_reach = row_of(reach, active)
        keeps = torch.ones_like(share[..., :1], dtype=torch.bool)
        for fraction in CHECKED_FRACTIONS:
            others = self.positions(now + fraction * window)
            linked = torch.cdist(others, others) <= reach
            linked = linked & ~torch.eye(linked.shape[-1], dtype=torch.bool, device=linked.device)
            without = linked & ~is_active[..., None, :] & ~is_active[..., :, None]
            degree = without.sum(-1)
            moved = here[..., None, :] + step * (fraction * share)[..., None]
            places = torch.cat([moved, here[..., None, :]], dim=2)
            link = (torch.cdist(places, others) <= own_reach[..., None, :]) & ~is_active[
                ..., None, :
            ]
            enough = (degree[..., None, :] + link >= self._need[..., None, :]) | is_active[
                ..., None, :
            ]
            own_need = self._need.expand_as(degree).gather(-1, active[..., None])
            ok = enough.all(-1) & (link.sum(-1) >= own_need)
            keeps = keeps & ok
        stay = link[..., -1, :]
        degree = torch.where(is_active, stay.sum(-1, keepdim=True), degree + stay)
        return keeps, degree

    def _allowed(
        self, active: Tensor, now: Tensor, duration: Tensor, others_free: Tensor, keeps: Tensor
    ) -> Tensor:
        """Choices after masking; where every choice breaks a rule, the mildest are left."""
        free = ~self.visited
        t_max = self.batch.t_max[:, None].expand_as(self.arrive).gather(-1, active[..., None])
        in_time = free & (now[..., None] + duration <= t_max)
        may_stop = (torch.isfinite(others_free) | ~free.any(-1))[..., None]
        good = torch.cat([in_time & keeps[..., :-1], may_stop & keeps[..., -1:]], dim=-1)
        fair = torch.cat([in_time, may_stop], dim=-1)
        poor = torch.cat([free, may_stop], dim=-1)
        allowed = torch.where(fair.any(-1, keepdim=True), fair, poor)
        return torch.where(good.any(-1, keepdim=True), good, allowed)
