"""Routes from the trained policy: greedy, sampling and the eight symmetries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.compiled_policy import CompiledPolicy, Flown
from jfto_planner.policy.problems import problems_of
from jfto_planner.routing.problem import RoutingProblem

MODES = ("greedy", "sample", "symmetry")
SAMPLES = 128
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
    policy: CompiledPolicy,
    problem: RoutingProblem,
    *,
    mode: str = "greedy",
    samples: int = SAMPLES,
    seed: int = 0,
) -> PolicyRoutes:
    """Routes for one problem.

    "greedy" takes the likeliest choice, "sample" the best of `samples` random rollouts, "symmetry"
    the best greedy rollout of the scene's eight reflections and rotations. Raises InputError for
    an unknown mode.
    """
    problems = problems_of(problem)
    if mode == "greedy":
        flown = policy.roll_out(problems)
    elif mode == "sample":
        steps = problem.waypoint_count + problem.uav_count
        chances = np.random.default_rng(seed).random((1, samples, steps))
        flown = policy.roll_out(problems, samples, chances=chances)
    elif mode == "symmetry":
        flown = policy.roll_out(problems.symmetries())
    else:
        raise InputError(f"mode is {mode!r}, must be one of {', '.join(MODES)}.")
    return _best(flown, float(problems.extent_m[0]), problem)


def _best(flown: Flown, extent_m: float, problem: RoutingProblem) -> PolicyRoutes:
    broken = flown.misses + flown.late
    winner = np.unravel_index(np.argmin(flown.length + PENALTY * broken), broken.shape)
    mean_speed = sum(limit.speed_mps for limit in problem.limits) / problem.uav_count
    routes: list[list[int]] = [[] for _ in range(problem.uav_count)]
    for choice, uav in zip(flown.choices[winner], flown.uavs[winner], strict=True):
        if choice < problem.waypoint_count:
            routes[uav].append(int(choice))
    return PolicyRoutes(
        routes=tuple(map(tuple, routes)),
        length_m=float(flown.length[winner]) * extent_m,
        misses=int(flown.misses[winner]),
        late_s=float(flown.late[winner]) * extent_m / mean_speed,
        feasible_share=float((broken <= 0).mean()),
    )
