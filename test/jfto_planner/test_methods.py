"""Ways to find routes."""

from __future__ import annotations

from dataclasses import replace

import pytest

from jfto_planner.methods import first_sound_routes, learned_routes, search_from, solve
from jfto_planner.policy.problems import problem_of
from jfto_planner.policy.weights import load_weights
from jfto_planner.routing import RoutingProblem, SearchSettings, search
from support.policy_cases import instances

EFFORT = SearchSettings(moves=4000, starts=2)


def _problem() -> RoutingProblem:
    return problem_of(instances(1, 15, 4, seed=2, k_min=2), 0, slots=40)


@pytest.mark.parametrize("method", ["rl", "rl+search", "search", "auto"])
def test_every_method_visits_everything_once_and_repeats_itself(method) -> None:
    """The same seed gives the same routes, and the routes are complete."""
    problem = _problem()
    first, second = (solve(problem, EFFORT, method=method, seed=5) for _ in range(2))
    assert first.found.routes == second.found.routes
    assert sorted(sum(first.found.routes, ())) == list(range(15))
    assert first.found.assessment == second.found.assessment


@pytest.mark.parametrize("method", ["rl", "rl+search"])
def test_a_learned_result_is_shown_beside_the_search(method) -> None:
    """The gap is the excess length over the search alone with the same effort."""
    solved = solve(_problem(), EFFORT, method=method, seed=5)
    alone = solve(_problem(), EFFORT, method="search", seed=5)
    assert solved.classical is not None
    assert solved.classical.routes == alone.found.routes
    assert "search alone" in solved.in_words()
    if solved.found.feasible:
        assert solved.gap == pytest.approx(solved.found.length_m / alone.found.length_m - 1)
    else:
        assert solved.gap is None
    assert alone.in_words() == ""


def test_the_search_is_no_worse_for_starting_from_sound_learned_routes() -> None:
    """A sound warm start is never made longer."""
    problem = _problem()
    learned = solve(problem, EFFORT, method="rl", seed=5).found
    both = solve(problem, EFFORT, method="rl+search", seed=5).found
    assert both.feasible
    assert not learned.feasible or both.length_m <= learned.length_m + 1e-6


def test_what_is_flown_is_the_better_of_both_searches() -> None:
    """Where starting from the policy did not help, the search's own routes are kept and named."""
    solved = solve(_problem(), EFFORT, method="rl+search", seed=5)
    alone = solved.classical
    assert alone is not None
    worse = replace(solved, found=replace(alone, length_m=alone.length_m + 1.0))
    assert worse.best is alone
    assert "the latter kept" in worse.in_words()
    assert solved.best.length_m <= min(solved.found.length_m, alone.length_m)


def test_the_first_sound_routes_are_sound_if_any_symmetry_is() -> None:
    """Over several problems: as often sound as the best of the eight symmetries, or oftener."""
    policy = load_weights()
    batch = instances(6, 15, 4, seed=2, k_min=2)
    problems = [problem_of(batch, row, slots=40) for row in range(6)]
    first = [first_sound_routes(policy, problem).feasible for problem in problems]
    best = [learned_routes(policy, problem, ("symmetry",), 0).feasible for problem in problems]
    assert any(first)
    assert first == best


def test_the_search_starts_from_nothing_where_the_policy_is_unsound() -> None:
    """Unsound routes change nothing of what the search finds; sound ones are never made longer."""
    problem = _problem()
    alone = search(problem, EFFORT, seed=5)
    start = replace(alone, routes=alone.routes[::-1], feasible=False)
    assert search_from(problem, EFFORT, start, seed=5).routes == alone.routes
    again = search_from(problem, EFFORT, alone, seed=5)
    assert again.feasible
    assert again.length_m <= alone.length_m + 1e-6
