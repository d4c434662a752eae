"""The learned planner against the search and against PyVRP, on problems that it never saw.

    python bench/policy.py [--instances 200] [--sampled 40] [--slow 24] [--sizes 20 50 136]
                           [--uavs 4 8] [--seconds 2] [--pyvrp-seconds 2] [--weights FILE]

Problems are drawn like those of the training, from other random numbers. Greedy rollouts and those
of eight symmetries run on all; 128 samples on the first `--sampled` of each size; the search, the
search from the policy's routes (`rl+search`, the policy's time counted) and PyVRP, which knows
nothing of the radio, on the first `--slow`. Gaps are over PyVRP's length, on the problems that
PyVRP and the method both solved; `feasible` is the share whose routes pass the exact check. Times
are of one core, after loading and compiling. `first` is the time until a sound plan is there: the
policy's greedy one, or else that of the first symmetry that is sound, or else the search's after
them; beside it that of the search alone. Where other jobs share the core, CPU compares better.
"""

from __future__ import annotations

import argparse
import math
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch

from jfto_planner.methods import first_sound_routes, learned_routes, search_from
from jfto_planner.policy.compiled_policy import CompiledPolicy
from jfto_planner.policy.problems import problem_of
from jfto_planner.policy.training import generator
from jfto_planner.policy.training.generator import HELD_OUT, generator_of
from jfto_planner.policy.weights import load_weights
from jfto_planner.routing import RoutingProblem, SearchSettings, search
from jfto_planner.routing.annealer import Annealer
from jfto_planner.routing.search import SearchResult
from routing import radio_free_length_m

SEED = 97


@dataclass(frozen=True)
class Outcome:
    """Length in m (inf where a rule is broken), and seconds, per problem."""

    lengths: np.ndarray
    seconds: np.ndarray


def options() -> argparse.Namespace:
    """Command line of this benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--instances", type=int, default=200)
    parser.add_argument("--sampled", type=int, default=40)
    parser.add_argument("--slow", type=int, default=24)
    parser.add_argument("--sizes", type=int, nargs="+", default=[20, 50, 136])
    parser.add_argument("--uavs", type=int, nargs="+", default=[4, 8])
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--pyvrp-seconds", type=float, default=2.0)
    parser.add_argument("--weights", type=Path)
    return parser.parse_args()


def run(problems: list[RoutingProblem], solve: Callable[[RoutingProblem], SearchResult]) -> Outcome:
    """Solve each problem and keep the clock."""
    lengths, seconds = [], []
    for problem in problems:
        begun = time.perf_counter()
        result = solve(problem)
        seconds.append(time.perf_counter() - begun)
        lengths.append(result.length_m if result.feasible else math.inf)
    return Outcome(np.array(lengths), np.array(seconds))


def effort(seconds: float) -> SearchSettings:
    """The search on one core for so long."""
    return SearchSettings(moves=None, time_limit_s=seconds, starts=1, workers=1)


def clocks_s() -> np.ndarray:
    """Seconds of CPU of this process, and by the clock."""
    return np.array([time.process_time(), time.perf_counter()])


def first_sound_s(problem: RoutingProblem, limit_s: float) -> np.ndarray:
    """Seconds (CPU, clock) until the search has sound routes."""
    begun = clocks_s()
    annealer = Annealer(problem, effort(limit_s), 0, None)
    found: list[np.ndarray] = []

    def observe(_: float, length_m: float, __: float) -> None:
        if math.isfinite(length_m) and not found:
            found.append(clocks_s() - begun)

    def pace(_: int) -> float:
        return 1.0 if found else (clocks_s() - begun)[1] / limit_s

    annealer.run(pace, lambda: False, observe)
    return found[0] if found else np.full(2, math.inf)


def first_times_s(policy: CompiledPolicy, problem: RoutingProblem) -> np.ndarray:
    """Seconds (CPU, clock) until the first sound plan: with the policy, and by the search alone."""
    begun = clocks_s()
    learned = first_sound_routes(policy, problem)
    with_policy = clocks_s() - begun
    alone = first_sound_s(problem, 10.0)
    return np.array([with_policy if learned.feasible else with_policy + alone, alone])


def bench_size(
    policy: CompiledPolicy, waypoints: int, uavs: int, chosen: argparse.Namespace
) -> None:
    """Print the rows of one size."""
    random = generator_of(SEED, HELD_OUT, 1000 * waypoints + uavs)
    ranges = generator.SceneRanges()
    batch = generator.draw(random, chosen.instances, waypoints, uavs, ranges)
    problems = [problem_of(batch, row) for row in range(chosen.instances)]
    few = problems[: chosen.slow]
    reference = np.array([radio_free_length_m(one, chosen.pyvrp_seconds, 0)[0] for one in few])

    def learned(mode: str) -> Callable[[RoutingProblem], SearchResult]:
        return lambda problem: learned_routes(policy, problem, (mode,), 0)

    def learned_then_searched(problem: RoutingProblem) -> SearchResult:
        start = first_sound_routes(policy, problem)
        left = max(chosen.seconds - start.seconds, 0.05)
        return search_from(problem, effort(left), start, seed=0)

    rows = {mode: run(problems, learned(mode)) for mode in ("greedy", "symmetry")}
    rows["sample"] = run(problems[: chosen.sampled], learned("sample"))
    rows["search"] = run(few, lambda problem: search(problem, effort(chosen.seconds), seed=0))
    rows["rl+search"] = run(few, learned_then_searched)
    for name, outcome in rows.items():
        sound = np.isfinite(outcome.lengths)
        shared = min(len(sound), len(few))
        both = np.flatnonzero(sound[:shared] & np.isfinite(reference[:shared]))
        gap = outcome.lengths[both].sum() / reference[both].sum() - 1
        print(
            f"{waypoints:4d} {uavs:2d}  {name:9s} {100 * gap:8.2f} % {100 * sound.mean():8.1f} % "
            f"{len(sound):5d} {len(both):5d} {1e3 * np.median(outcome.seconds):9.1f} ms",
            flush=True,
        )
    times = np.median([first_times_s(policy, one) for one in few], axis=0)
    for clock, (with_policy, alone) in zip(("CPU", "the clock"), times.T, strict=True):
        print(
            f"{waypoints:4d} {uavs:2d}  first sound plan: {1e3 * with_policy:.1f} ms of {clock} "
            f"with the policy, {1e3 * alone:.1f} ms by the search, "
            f"{alone / with_policy:.2f} times sooner",
            flush=True,
        )


def main() -> int:
    """Print a table for every size."""
    torch.set_num_threads(1)
    chosen = options()
    policy = load_weights(chosen.weights)
    warm = generator.draw(generator_of(SEED, HELD_OUT, 0), 1, 12, 4, generator.SceneRanges())
    first_times_s(policy, problem_of(warm, 0))
    print("   W  A  method         gap     feasible   run  compared    median time")
    for waypoints in chosen.sizes:
        for uavs in chosen.uavs:
            bench_size(policy, waypoints, uavs, chosen)
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"greatest memory of this process, torch and PyVRP included: {used:.0f} MB")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
