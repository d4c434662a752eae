"""The policy g_θ: encoder, decoder and rollouts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor, nn

from jfto_planner.policy.compiled_policy import CompiledPolicy
from jfto_planner.policy.decoder import Decoder, Keys
from jfto_planner.policy.encoder import Encoder
from jfto_planner.policy.environment import Episode, Observation
from jfto_planner.policy.instance import InstanceBatch
from jfto_planner.policy.replay import recorded
from jfto_planner.policy.shape import PolicyShape


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
        keys = self.encode(batch)
        with torch.no_grad():
            if batch.waypoints.device.type == "cpu" and first is None:
                outcome, seen = self._compiled(keys, batch, rollouts, generator)
            else:
                outcome, seen = self.stepwise(keys, batch, rollouts, generator, first)
        if not torch.is_grad_enabled():
            return outcome
        # All steps in one pass: the choices are known by now.
        return replace(outcome, log_likelihood=self.log_likelihood(keys, seen, outcome.choices))

    def stepwise(
        self,
        keys: Keys,
        batch: InstanceBatch,
        rollouts: int,
        generator: torch.Generator | None,
        first: Tensor | None = None,
    ) -> tuple[Rollouts, Observation]:
        """Rollouts and what was seen at all steps, on any device."""
        episode = Episode(batch, rollouts)
        choices, steps = [], []
        total = torch.zeros(batch.size, rollouts, device=batch.waypoints.device)
        for number in range(episode.steps):
            seen = episode.observe()
            log_p = self.decoder(keys, seen)
            choice = _choose(log_p, generator)
            if number == 0 and first is not None:
                possible = seen.allowed.gather(-1, first[..., None]).squeeze(-1)
                choice = torch.where(possible, first, choice)
            total = total + log_p.gather(-1, choice[..., None]).squeeze(-1)
            episode.step(choice)
            choices.append(choice)
            steps.append(seen)
        outcome = Rollouts(
            torch.stack(choices, -1),
            torch.stack([seen.active for seen in steps], -1),
            total,
            episode.length,
            episode.misses,
            episode.late,
        )
        return outcome, Observation.of_steps(steps)

    def _compiled(
        self,
        keys: Keys,
        batch: InstanceBatch,
        rollouts: int,
        generator: torch.Generator | None,
    ) -> tuple[Rollouts, Observation]:
        """The same on a CPU."""
        chances = None
        if generator is not None:
            shape = (batch.size, rollouts, batch.waypoints.shape[1] + batch.start_of.shape[1])
            chances = torch.rand(shape, generator=generator, dtype=torch.float64).numpy()
        compiled = CompiledPolicy(arrays_of(self), self.shape)
        flown = compiled.roll_out(
            batch.numpy(), rollouts, chances=chances, known=keys.known(), record=True
        )
        columns = (
            flown.choices,
            flown.uavs,
            flown.log_likelihood.astype(np.float32),
            flown.length,
            flown.misses,
            flown.late,
        )
        return Rollouts(*map(torch.from_numpy, columns)), recorded(flown.view)

    def encode(self, batch: InstanceBatch) -> Keys:
        """Everything that the decoder needs of the problems themselves."""
        nodes, graph, _ = self.encoder(batch)
        return self.decoder.prepare(nodes, graph, batch)

    def log_likelihood(self, keys: Keys, seen: Observation, choices: Tensor) -> Tensor:
        """Log likelihood (B, P) of choices (B, P, T) given the observations of all their steps."""
        log_p = self.decoder(keys, seen).gather(-1, choices.flatten(1)[..., None])
        return log_p.view(choices.shape).sum(-1)


def arrays_of(policy: Policy) -> dict[str, np.ndarray]:
    """Weights by name, single precision."""
    return {key: value.detach().cpu().numpy() for key, value in policy.state_dict().items()}


def _choose(log_p: Tensor, generator: torch.Generator | None) -> Tensor:
    if generator is None:
        return log_p.argmax(-1)
    chances = log_p.exp().flatten(0, 1)
    drawn = torch.multinomial(chances, 1, generator=generator)
    return drawn.view(log_p.shape[:-1])
