"""Rollouts of the policy."""

from __future__ import annotations

import itertools
from dataclasses import fields

import numpy as np
import pytest
import torch

from jfto_planner.policy.compiled_policy import CompiledPolicy
from jfto_planner.policy.network.environment import Episode
from jfto_planner.policy.network.model import Policy, arrays_of
from jfto_planner.policy.observation import Observation
from jfto_planner.policy.problems import symmetries
from support.policy_cases import SMALL, instances, line_of_three, stack


def _policy() -> Policy:
    torch.manual_seed(3)
    return Policy(SMALL).eval()


def _likelihoods(policy: Policy, batch, paths: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Log likelihood and cost of prescribed choice sequences (P, steps) of one problem."""
    keys = policy.encode(batch)
    episode = Episode(batch, len(paths))
    total = torch.zeros(1, len(paths))
    for step in paths.T:
        seen = episode.observe()
        total = total + policy.decoder(keys, seen).gather(-1, step[None, :, None])[..., 0]
        episode.step(step[None])
    return total[0], episode.length[0]


@pytest.mark.slow
def test_sampling_estimates_the_gradient_of_the_expected_length() -> None:
    """On an instance with few enough outcomes to list them all, the exact gradient of E[L] equals
    the score-function form Σ π L ∇log π, and sampled rollouts with a baseline approach it.
    """
    policy = _policy()
    batch = line_of_three(reach=10)
    parameter = policy.decoder.stop_bias
    paths = torch.tensor(list(itertools.product(range(4), repeat=5)))
    log_p, length = _likelihoods(policy, batch, paths)
    real = torch.isfinite(log_p)
    chance = log_p[real].exp()
    assert abs(float(chance.detach().sum()) - 1) < 1e-5
    (exact,) = torch.autograd.grad((chance * length[real]).sum(), parameter, retain_graph=True)
    score = (chance.detach() * length[real] * log_p[real]).sum()
    (estimate,) = torch.autograd.grad(score, parameter)
    torch.testing.assert_close(exact, estimate, rtol=1e-4, atol=1e-6)
    outcome = policy(batch, 20_000, generator=torch.Generator().manual_seed(5))
    advantage = outcome.length - outcome.length.mean()
    (sampled,) = torch.autograd.grad((advantage * outcome.log_likelihood).mean(), parameter)
    assert abs(float(sampled - exact)) < 0.1 * abs(float(exact)) + 2e-3


def test_the_same_seed_gives_the_same_rollouts() -> None:
    """Sampling depends on the generator alone."""
    policy = _policy()
    batch = instances(4, 8, 4, k_min=2)
    first, second = (
        policy(batch, 6, generator=torch.Generator().manual_seed(9)).choices for _ in range(2)
    )
    assert torch.equal(first, second)


def test_a_batch_of_mixed_sizes_equals_its_problems_one_by_one() -> None:
    """Padding with absent waypoints, starts and UAVs changes no choice and no length."""
    policy = _policy()
    single = [instances(1, w, a, seed=w, k_min=2) for w, a in ((5, 3), (9, 4), (12, 6))]
    together = policy(stack(single))
    for row, batch in enumerate(single):
        alone = policy(batch)
        torch.testing.assert_close(together.length[row], alone.length[0])
        assert float(together.misses[row]) == float(alone.misses[0])


def test_one_pass_over_all_steps_gives_the_likelihood_of_the_rollout() -> None:
    """What is learned from is the likelihood with which the rollout was drawn."""
    policy = _policy()
    batch = instances(3, 8, 4, k_min=2)
    learning = policy(batch, 5, generator=torch.Generator().manual_seed(2))
    with torch.no_grad():
        drawn = policy(batch, 5, generator=torch.Generator().manual_seed(2))
    assert learning.log_likelihood.requires_grad
    assert torch.equal(learning.choices, drawn.choices)
    torch.testing.assert_close(learning.log_likelihood.detach(), drawn.log_likelihood)


@torch.no_grad()
def test_compiled_rollouts_equal_those_in_tensors() -> None:
    """On a CPU the environment and the decoder run compiled: same choices, lengths, likelihoods."""
    policy = _policy()
    batch = stack([instances(2, w, a, seed=w, k_min=2) for w, a in ((7, 3), (12, 6), (20, 5))])
    expected = policy.stepwise(policy.encode(batch), batch, 1, None)
    compiled = policy(batch)
    assert torch.equal(compiled.choices, expected.choices)
    torch.testing.assert_close(compiled.length, expected.length)
    torch.testing.assert_close(compiled.late, expected.late)
    assert torch.equal(compiled.misses, expected.misses)
    torch.testing.assert_close(compiled.log_likelihood, expected.log_likelihood, rtol=1e-4, atol=0)
    assert expected.seen.pair.shape[1] == compiled.choices.shape[-1]


@torch.no_grad()
def test_what_is_seen_compiled_equals_what_is_seen_in_tensors() -> None:
    """At every step, for whoever chooses: same mask, clocks and features, also of padding."""
    policy = _policy()
    batch = stack([instances(3, w, a, seed=w, k_min=2) for w, a in ((7, 3), (12, 6), (20, 5))])
    keys = policy.encode(batch)
    expected = policy.stepwise(keys, batch, 1, None).seen
    compiled = CompiledPolicy(arrays_of(policy), SMALL)
    found = compiled.roll_out(batch.numpy(), keys=keys.numpy(), record=True).seen.tensors()
    free = ~expected.visited
    for item in fields(Observation):
        one, other = getattr(found, item.name), getattr(expected, item.name)
        if item.name == "duration":
            one, other = one[free], other[free]
        if item.name == "keeps_rule":
            assert torch.equal(one[..., -1], other[..., -1])
            one, other = one[..., :-1][free], other[..., :-1][free]
        torch.testing.assert_close(one, other, rtol=1e-4, atol=1e-5, msg=item.name)


@torch.no_grad()
def test_the_encoder_in_numpy_equals_the_one_in_torch() -> None:
    """Inference needs no torch: the same embeddings, also of padded problems, in evaluation."""
    policy = _policy()
    for layer in policy.encoder.layers:
        layer.norm_attention.norm.running_mean.uniform_(-0.5, 0.5)
        layer.norm_feed_forward.norm.running_var.uniform_(0.5, 2.0)
    batch = stack([instances(2, w, a, seed=w) for w, a in ((7, 3), (12, 6))])
    compiled = CompiledPolicy(arrays_of(policy), SMALL)
    expected, found = policy.encode(batch).numpy(), compiled.encode(batch.numpy())
    for name in ("graph", "node_part", "glimpse_key", "pointer_key", "pair_key", "stop_key"):
        np.testing.assert_allclose(
            getattr(found, name), getattr(expected, name), rtol=1e-4, atol=1e-5
        )
    assert found.graph.shape == (4, SMALL.width)


def test_symmetries_preserve_every_distance() -> None:
    """Reflections and rotations change coordinates, not the problem."""
    batch = instances(2, 6, 4)
    eight = symmetries(batch.numpy()).tensors()
    assert eight.size == 16
    for copy in range(8):
        rows = slice(2 * copy, 2 * copy + 2)
        torch.testing.assert_close(
            torch.cdist(eight.waypoints[rows], eight.starts[rows]),
            torch.cdist(batch.waypoints, batch.starts),
            rtol=1e-4,
            atol=1e-5,
        )
