"""How routes are found: by the search, by the trained policy, or by one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from jfto_planner.policy.compiled_policy import CompiledPolicy
from jfto_planner.policy.inference import PolicyRoutes, ranked_routes, turned_routes
from jfto_planner.policy.weights import load_weights
from jfto_planner.routing import RoutingProblem, SearchResult, SearchSettings, search
from jfto_planner.routing.assess import Routes, assess

SEARCH, RL, RL_SEARCH, AUTO = "search", "rl", "rl+search", "auto"
Progress = Callable[[float, str], None]
# Rollouts of a mode that are checked exactly, best first, until one is sound: the policy's own
# check sees fewer instants.
CHECKED = 16
# Temperature at which the search takes up the policy's routes, over that of other warm starts.
LEARNED_HEAT = 3.0


@dataclass(frozen=True)
class MethodResult:
    """Routes, the method that found them and, beside a learned one, what the search alone found
    with the same effort.
    """

    found: SearchResult
    method: str
    classical: SearchResult | None = None

    @property
    def gap(self) -> float | None:
        """Excess length over the search alone as a share; None where there is nothing to compare.

        A result that breaks a rule has no gap, whatever its length.
        """
        if self.classical is None or not (self.found.feasible and self.classical.feasible):
            return None
        return self.found.length_m / self.classical.length_m - 1

    @property
    def best(self) -> SearchResult:
        """What to fly: for "rl+search" the search alone's routes where they are better."""
        if self.method != RL_SEARCH or self.classical is None:
            return self.found
        return min(self.found, self.classical, key=_rank)

    def in_words(self) -> str:
        """One line for the user; empty for the search alone."""
        if self.classical is None:
            return ""
        text = f"{self.method} {_length(self.found)}, search alone {_length(self.classical)}"
        if self.gap is not None:
            text += f": gap {100 * self.gap:+.2f} %"
        return text + ("" if self.best is self.found else ", the latter kept")


def _length(result: SearchResult) -> str:
    return f"{result.length_m / 1000:.2f} km" + ("" if result.feasible else " breaking rules")


# What "auto" stands for, by measurement (docs/explanation/policy.md).
BEST = SEARCH


def solve(
    problem: RoutingProblem,
    settings: SearchSettings,
    *,
    method: str = SEARCH,
    seed: int,
    warm_start: Routes | None = None,
    progress: Progress | None = None,
) -> MethodResult:
    """Find routes by a method.

    "rl" takes the best of 128 rollouts and of the greedy ones of the scene's eight reflections and
    rotations; "rl+search" starts the search from the first of those eight that is sound. Both are
    compared with the search alone. The same seed gives the same routes.

    Raises
    ------
    InputError
        If the weights are missing or damaged, or `warm_start` does not fit.
    """
    method = BEST if method == AUTO else method
    # Before the search, so that missing weights are not found out after it.
    policy = None if method == SEARCH else load_weights()
    classical = search(problem, settings, seed=seed, warm_start=warm_start, progress=progress)
    if policy is None or classical.stopped_by == "user":
        return MethodResult(classical, SEARCH)
    if method == RL:
        found = learned_routes(policy, problem, ("symmetry", "sample"), seed)
        return MethodResult(found, RL, classical)
    learned = first_sound_routes(policy, problem)
    found = search_from(problem, settings, learned, seed=seed, progress=progress)
    return MethodResult(found, RL_SEARCH, classical)


def learned_routes(
    policy: CompiledPolicy, problem: RoutingProblem, modes: Sequence[str], seed: int
) -> SearchResult:
    """The policy's best routes in some modes of inference that pass the exact check."""
    begun_s = time.monotonic()
    candidates = [
        _best_sound(problem, ranked_routes(policy, problem, mode=mode, seed=seed, most=CHECKED))
        for mode in modes
    ]
    return replace(min(candidates, key=_rank), seconds=time.monotonic() - begun_s)


def first_sound_routes(policy: CompiledPolicy, problem: RoutingProblem) -> SearchResult:
    """The policy's greedy routes, of the scene as it is or else of the first of its reflections and
    rotations that passes the exact check; the closest where none does.
    """
    begun_s = time.monotonic()
    found = _best_sound(problem, turned_routes(policy, problem))
    return replace(found, seconds=time.monotonic() - begun_s)


def search_from(
    problem: RoutingProblem,
    settings: SearchSettings,
    learned: SearchResult,
    *,
    seed: int,
    progress: Progress | None = None,
) -> SearchResult:
    """The search from the policy's routes where they are sound, else from nothing.

    It starts hotter than from a plan that is to be kept: the policy's routes are some percent off.
    """
    if not learned.feasible:
        return search(problem, settings, seed=seed, progress=progress)
    warm = replace(settings, hottest=settings.hottest * LEARNED_HEAT)
    return search(problem, warm, seed=seed, warm_start=learned.routes, progress=progress)


def _best_sound(problem: RoutingProblem, ranked: Iterable[PolicyRoutes]) -> SearchResult:
    """The first sound of some routes, else the closest to sound."""
    judged = []
    for one in ranked:
        judged.append(_judged(problem, one.routes))
        if judged[-1].feasible:
            break
    return min(judged, key=_rank)


def _judged(problem: RoutingProblem, routes: Routes) -> SearchResult:
    assessment = assess(problem, routes)
    length = assessment.length_m
    return SearchResult(
        routes=routes,
        length_m=length,
        feasible=assessment.clean,
        assessment=assessment,
        moves=0,
        seconds=0.0,
        stopped_by="",
        lengths_m=(length if assessment.clean else float("inf"),),
    )


def _rank(result: SearchResult) -> tuple[bool, float, float]:
    """Sound routes first, by length, then the others by how far they are from sound."""
    severity = 0.0 if result.feasible else result.assessment.severity
    return not result.feasible, severity, result.length_m
