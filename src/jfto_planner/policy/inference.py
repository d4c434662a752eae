"""Routes from the trained policy: greedy, sampling and the eight symmetries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import AnyArray
from jfto_planner.policy.compiled_policy import CompiledPolicy, Rollouts
from jfto_planner.policy.problems import SYMMETRIES, problems_of, symmetries, turned
from jfto_planner.routing.problem import RoutingProblem

MODES = ("greedy", "sample", "symmetry")
SAMPLES = 128
# Broken rules outweigh any length: the cleanest rollout is taken, then the shortest.
PENALTY = 1e3


@dataclass(frozen=True)
class PolicyRoutes:
    """A rollout: waypoint indices per UAV, length in m, and how many choices broke a rule."""

    routes: tuple[tuple[int, ...], ...]
    length_m: float
    misses: int
    late_s: float


def ranked_routes(
    policy: CompiledPolicy,
    problem: RoutingProblem,
    *,
    mode: str,
    samples: int = SAMPLES,
    seed: int = 0,
    most: int,
) -> list[PolicyRoutes]:
    """The `most` best rollouts of a mode, no routes twice, best first.

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
        flown = policy.roll_out(symmetries(problems))
    else:
        raise InputError(f"mode is {mode!r}, must be one of {', '.join(MODES)}.")
    return _ranked(flown, float(problems.extent_m[0]), problem, most)


def turned_routes(policy: CompiledPolicy, problem: RoutingProblem) -> Iterator[PolicyRoutes]:
    """Greedy routes of the scene as it is, then of its other reflections and rotations, one by one.

    For whoever stops at the first that will do.
    """
    problems = problems_of(problem)
    for turn in range(SYMMETRIES):
        flown = policy.roll_out(turned(problems, np.array([turn])))
        yield from _ranked(flown, float(problems.extent_m[0]), problem, 1)


def _ranked(
    flown: Rollouts[AnyArray], extent_m: float, problem: RoutingProblem, most: int
) -> list[PolicyRoutes]:
    broken = flown.misses + flown.late
    mean_speed = sum(limit.speed_mps for limit in problem.limits) / problem.uav_count
    best: dict[tuple[tuple[int, ...], ...], PolicyRoutes] = {}
    for place in np.argsort(flown.length + PENALTY * broken, axis=None, kind="stable"):
        row = np.unravel_index(place, broken.shape)
        routes: list[list[int]] = [[] for _ in range(problem.uav_count)]
        for choice, uav in zip(flown.choices[row], flown.uavs[row], strict=True):
            if choice < problem.waypoint_count:
                routes[uav].append(int(choice))
        found = PolicyRoutes(
            routes=tuple(map(tuple, routes)),
            length_m=float(flown.length[row]) * extent_m,
            misses=int(flown.misses[row]),
            late_s=float(flown.late[row]) * extent_m / mean_speed,
        )
        best.setdefault(found.routes, found)
        if len(best) == most:
            break
    return list(best.values())
