"""Routes from the trained policy: greedy, sampling and the eight symmetries."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.instance import InstanceBatch, from_problem, symmetries
from jfto_planner.policy.model import Policy, Rollouts
from jfto_planner.routing.problem import RoutingProblem

MODES = ("greedy", "sample", "symmetry")
# Broken rules outweigh any length: the cleanest rollout is taken, then the shortest.
PENALTY = 1e3


@dataclass(frozen=True)
class PolicyRoutes:
    """Best rollout: waypoint indices per UAV, length in m, and how many choices broke a rule.

    `feasible_share` is the share of all rollouts that broke none.
    """

    routes: tuple[tuple[int, ...], ...]
    length_m: float
    misses: int
    late_s: float
    feasible_share: float


def plan_routes(
    policy: Policy, problem: RoutingProblem, *, mode: str = "greedy", samples: int = 128, seed: int
) -> PolicyRoutes:
    """Routes for one problem.

    "greedy" takes the likeliest choice, "sample" the best of `samples` random rollouts, "symmetry"
    the best greedy rollout of the scene's eight reflections and rotations. Raises InputError for
    an unknown mode.
    """
    if mode not in MODES:
        raise InputError(f"mode is {mode!r}, must be one of {', '.join(MODES)}.")
    batch = from_problem(problem)
    with torch.inference_mode():
        if mode == "greedy":
            outcome = policy(batch)
        elif mode == "sample":
            outcome = policy(batch, samples, generator=torch.Generator().manual_seed(seed))
        else:
            outcome = policy(symmetries(batch))
    return _best(outcome, batch, problem)


def _best(outcome: Rollouts, batch: InstanceBatch, problem: RoutingProblem) -> PolicyRoutes:
    cost = outcome.cost(PENALTY, PENALTY).flatten()
    winner = int(cost.argmin())
    extent = float(batch.extent_m[0])
    clean = (outcome.misses == 0) & (outcome.late <= 0)
    mean_speed = sum(limit.speed_mps for limit in problem.limits) / problem.uav_count
    return PolicyRoutes(
        routes=_routes(
            outcome.choices.flatten(0, 1)[winner], outcome.uavs.flatten(0, 1)[winner], problem
        ),
        length_m=float(outcome.length.flatten()[winner]) * extent,
        misses=int(outcome.misses.flatten()[winner]),
        late_s=float(outcome.late.flatten()[winner]) * extent / mean_speed,
        feasible_share=float(clean.float().mean()),
    )


def _routes(choices: Tensor, uavs: Tensor, problem: RoutingProblem) -> tuple[tuple[int, ...], ...]:
    routes: list[list[int]] = [[] for _ in range(problem.uav_count)]
    for choice, uav in zip(choices.tolist(), uavs.tolist(), strict=True):
        if choice < problem.waypoint_count:
            routes[uav].append(choice)
    return tuple(tuple(route) for route in routes)
