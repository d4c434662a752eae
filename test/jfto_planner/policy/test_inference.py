"""Routes from the policy: several of one mode, and symmetries one by one."""

from __future__ import annotations

import pytest

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.inference import ranked_routes, turned_routes
from jfto_planner.policy.problems import problem_of
from jfto_planner.policy.weights import load_weights
from jfto_planner.routing import RoutingProblem
from jfto_planner.routing.assess import assess
from support.policy_cases import instances


def _problem() -> RoutingProblem:
    return problem_of(instances(1, 12, 4, seed=3, k_min=2), 0, slots=40)


def test_ranked_routes_come_best_first_and_once() -> None:
    """Of 32 samples: unbroken ones first, by length; the first is the plan; all are complete."""
    policy, problem = load_weights(), _problem()
    ranked = ranked_routes(policy, problem, mode="sample", samples=32, seed=1, most=8)
    assert len(ranked) == 8
    assert len({one.routes for one in ranked}) == 8
    order = [(one.misses + one.late_s > 0, one.length_m) for one in ranked]
    sound = [length for broken, length in order if not broken]
    assert sound == sorted(sound)
    assert [broken for broken, _ in order] == sorted(broken for broken, _ in order)
    assert ranked_routes(policy, problem, mode="sample", samples=32, seed=1, most=1) == ranked[:1]
    assert all(sorted(sum(one.routes, ())) == list(range(12)) for one in ranked)


def test_symmetries_one_by_one_hold_the_best_of_all_at_once() -> None:
    """The first is the greedy plan, and among the eight is the one that "symmetry" takes."""
    policy, problem = load_weights(), _problem()
    turned = list(turned_routes(policy, problem))
    assert len(turned) == 8
    (greedy,) = ranked_routes(policy, problem, mode="greedy", most=1)
    assert turned[0].routes == greedy.routes
    (best,) = ranked_routes(policy, problem, mode="symmetry", most=1)
    assert best.length_m == pytest.approx(assess(problem, best.routes).length_m, rel=1e-5)
    assert best.routes in [one.routes for one in turned]


def test_an_unknown_mode_is_named() -> None:
    """The error says what was asked for and what there is."""
    with pytest.raises(InputError, match=r"beam.*greedy, sample, symmetry"):
        ranked_routes(load_weights(), _problem(), mode="beam", most=1)
