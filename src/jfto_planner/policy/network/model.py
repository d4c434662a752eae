"""The policy g_θ: encoder, decoder and rollouts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch
from torch import Tensor, nn

from jfto_planner.policy.compiled_policy import CompiledPolicy, PolicyShape, Rollouts
from jfto_planner.policy.kernel.decode import Keys
from jfto_planner.policy.network.decoder import Decoder
from jfto_planner.policy.network.encoder import Encoder
from jfto_planner.policy.network.environment import Episode
from jfto_planner.policy.observation import Observation, joined
from jfto_planner.policy.problems import Problems


class Policy(nn.Module):
    """Attention model that routes a fleet under the neighbour rule."""

    def __init__(self, shape: PolicyShape | None = None) -> None:
        super().__init__()
        self.shape = shape = shape or PolicyShape()
        self.encoder = Encoder(shape.width, shape.heads, shape.layers, shape.hidden)
        self.decoder = Decoder(shape.width, shape.heads, shape.clip)

    def forward(
        self,
        batch: Problems[Tensor],
        rollouts: int = 1,
        *,
        generator: torch.Generator | None = None,
    ) -> Rollouts[Tensor]:
        """Roll out P = `rollouts` solutions of each problem; all share one encoder pass.

        With a `generator` choices are sampled, without one the likeliest is taken.
        """
        keys = self.encode(batch)
        with torch.no_grad():
            if batch.waypoints.device.type == "cpu":
                flown = self._compiled(keys, batch, rollouts, generator)
            else:
                flown = self.stepwise(keys, batch, rollouts, generator)
        if not torch.is_grad_enabled():
            return flown
        # All steps in one pass: the choices are known by now.
        return replace(flown, log_likelihood=self.log_likelihood(keys, flown.seen, flown.choices))

    def stepwise(
        self,
        keys: Keys[Tensor],
        batch: Problems[Tensor],
        rollouts: int,
        generator: torch.Generator | None,
    ) -> Rollouts[Tensor]:
        """Rollouts and what was seen at all steps, in tensors on any device."""
        episode = Episode(batch, rollouts)
        choices, steps = [], []
        total = torch.zeros(batch.size, rollouts, device=batch.waypoints.device)
        for _ in range(episode.steps):
            seen = episode.observe()
            log_p = self.decoder(keys, seen)
            choice = _choose(log_p, generator)
            total = total + log_p.gather(-1, choice[..., None]).squeeze(-1)
            episode.step(choice)
            choices.append(choice)
            steps.append(seen)
        return Rollouts(
            torch.stack(choices, -1),
            torch.stack([seen.active for seen in steps], -1),
            total,
            episode.length,
            episode.misses,
            episode.late,
            joined(steps),
        )

    def _compiled(
        self,
        keys: Keys[Tensor],
        batch: Problems[Tensor],
        rollouts: int,
        generator: torch.Generator | None,
    ) -> Rollouts[Tensor]:
        """The same compiled, on a CPU."""
        chances = None
        if generator is not None:
            shape = (batch.size, rollouts, batch.waypoints.shape[1] + batch.start_of.shape[1])
            chances = torch.rand(shape, generator=generator, dtype=torch.float64).numpy()
        compiled = CompiledPolicy(arrays_of(self), self.shape)
        flown = compiled.roll_out(
            batch.numpy(),
            rollouts,
            chances=chances,
            keys=keys.numpy(),
            record=True,
        )
        return Rollouts(
            torch.from_numpy(flown.choices),
            torch.from_numpy(flown.uavs),
            torch.from_numpy(flown.log_likelihood).float(),
            torch.from_numpy(flown.length),
            torch.from_numpy(flown.misses),
            torch.from_numpy(flown.late),
            flown.seen.tensors(),
        )

    def encode(self, batch: Problems[Tensor]) -> Keys[Tensor]:
        """Everything that the decoder needs of the problems themselves."""
        nodes, graph, _ = self.encoder(batch)
        return self.decoder.prepare(nodes, graph, batch)

    def log_likelihood(
        self, keys: Keys[Tensor], seen: Observation[Tensor], choices: Tensor
    ) -> Tensor:
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
