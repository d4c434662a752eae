"""The policy g_θ: encoder, decoder and rollouts."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from jfto_planner.policy.decoder import Decoder
from jfto_planner.policy.encoder import Encoder
from jfto_planner.policy.environment import Episode
from jfto_planner.policy.instance import InstanceBatch


@dataclass(frozen=True)
class PolicyShape:
    """Sizes of the network: D_H, H, N_TP, the feed-forward width and C."""

    width: int = 128
    heads: int = 8
    layers: int = 3
    hidden: int = 512
    clip: float = 10.0


@dataclass(frozen=True)
class Rollouts:
    """Outcome of P rollouts of each of B problems.

    `choices` (B, P, steps) and `uavs` (B, P, steps) say who chose what (W = stop);
    `log_likelihood`, `length` (extents), `misses` and `late` are (B, P).
    """

    choices: Tensor
    uavs: Tensor
    log_likelihood: Tensor
    length: Tensor
    misses: Tensor
    late: Tensor

    def cost(self, miss_penalty: float, late_penalty: float) -> Tensor:
        """What training minimises: length plus penalties for broken rules, (B, P)."""
        return self.length + miss_penalty * self.misses + late_penalty * self.late


class Policy(nn.Module):
    """Attention model that routes a fleet under the neighbour rule."""

    def __init__(self, shape: PolicyShape | None = None) -> None:
        super().__init__()
        self.shape = shape = shape or PolicyShape()
        self.encoder = Encoder(shape.width, shape.heads, shape.layers, shape.hidden)
        self.decoder = Decoder(shape.width, shape.heads, shape.clip)

    def forward(
        self,
        batch: InstanceBatch,
        rollouts: int = 1,
        *,
        generator: torch.Generator | None = None,
        first: Tensor | None = None,
    ) -> Rollouts:
        """Roll out P = `rollouts` solutions of each problem; all share one encoder pass.

        With a `generator` choices are sampled, without one the likeliest is taken. `first`
        (B, P) prescribes the first waypoint of each rollout where it is allowed (multi-start).
        """
        nodes, graph, _ = self.encoder(batch)
        keys = self.decoder.prepare(nodes, graph, batch.starts.shape[1])
        episode = Episode(batch, rollouts)
        choices, uavs = [], []
        total = torch.zeros(batch.size, rollouts, device=nodes.device)
        for number in range(episode.steps):
            seen = episode.observe()
            log_p = self.decoder(keys, episode, seen)
            choice = _choose(log_p.detach(), generator)
            if number == 0 and first is not None:
                possible = seen.allowed.gather(-1, first[..., None]).squeeze(-1)
                choice = torch.where(possible, first, choice)
            total = total + log_p.gather(-1, choice[..., None]).squeeze(-1)
            episode.step(choice)
            choices.append(choice)
            uavs.append(seen.active)
        return Rollouts(
            torch.stack(choices, -1),
            torch.stack(uavs, -1),
            total,
            episode.length,
            episode.misses,
            episode.late,
        )


def _choose(log_p: Tensor, generator: torch.Generator | None) -> Tensor:
    if generator is None:
        return log_p.argmax(-1)
    chances = log_p.exp().flatten(0, 1)
    drawn = torch.multinomial(chances, 1, generator=generator)
    return drawn.view(log_p.shape[:-1])
