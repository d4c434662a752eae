"""The search keeps every rule, its promises on seeds and budgets, and says when it cannot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_planner.routing import RoutingProblem, SearchSettings, certify, search
from jfto_planner.routing.assess import assess
from jfto_world.radio import pairwise_distances

QUICK = SearchSettings(moves=160_000, starts=2)


def test_routes_are_certified_clean(make_problem, make_plan):
    """What the search calls feasible passes the independent certificate."""
    problem = make_problem(1)
    result = search(problem, QUICK, seed=5)
    assert result.feasible
    assert not result.interrupted
    certificate = certify(make_plan(problem, result.routes))
    assert certificate.clean, certificate.violations[:3]
    assert result.length_m == pytest.approx(make_plan(problem, result.routes).total_length_m)


def test_same_seed_same_routes_on_any_number_of_threads(make_problem):
    """The plan depends on seed and settings, not on how many threads run the starts."""
    one = search(make_problem(), SearchSettings(moves=80_000, starts=2, workers=1), seed=7)
    two = search(make_problem(), SearchSettings(moves=80_000, starts=2, workers=2), seed=7)
    assert one.routes == two.routes
    assert one.lengths_m == two.lengths_m
    assert one.moves == two.moves


def test_given_horizon_is_kept(make_problem, make_plan):
    """With a horizon shorter than T_max, routes end within it and hold until it ends."""
    problem = make_problem(horizon_s=100.0)
    result = search(problem, QUICK, seed=2)
    assert result.feasible
    plan = make_plan(problem, result.routes)
    assert plan.slots.horizon_s == pytest.approx(100.0)
    assert certify(plan).clean


def test_warm_start_is_never_made_longer(make_problem):
    """Starting from sound routes yields routes that are no longer."""
    problem = make_problem()
    first = search(problem, QUICK, seed=1)
    again = search(problem, SearchSettings(moves=2_000, starts=1), seed=9, warm_start=first.routes)
    assert again.feasible
    assert again.length_m <= first.length_m + 1e-9


@pytest.mark.parametrize(
    ("routes", "message"),
    [(((0,),), "1 routes for 4 UAVs"), (((0, 0), (), (), ()), "does not visit each")],
)
def test_wrong_warm_start_is_refused(make_problem, routes, message):
    """Warm starts must fit the fleet and visit every waypoint once."""
    with pytest.raises(InputError, match=message):
        search(make_problem(), QUICK, seed=1, warm_start=routes)


def test_user_interrupt_keeps_the_best_so_far(make_problem):
    """Ctrl-C ends the search and returns complete routes, marked as interrupted."""

    def interrupt(_fraction: float, _note: str) -> None:
        raise KeyboardInterrupt

    settings = SearchSettings(moves=50_000_000, starts=2)
    result = search(make_problem(), settings, seed=1, progress=interrupt)
    assert result.interrupted
    assert result.stopped_by == "user"
    assert sorted(node for route in result.routes for node in route) == list(range(24))
    assert result.moves < 50_000_000


def test_time_limit_ends_the_search(make_problem):
    """A time limit stops a search that has moves left, and the result says so."""
    settings = SearchSettings(moves=10**12, starts=2, time_limit_s=0.2)
    result = search(make_problem(), settings, seed=1)
    assert result.stopped_by == "time limit"
    assert sorted(node for route in result.routes for node in route) == list(range(24))


def test_progress_ends_at_one(make_problem):
    """Progress is reported from the caller's thread, never falls and ends at 1."""
    seen = []
    search(make_problem(), QUICK, seed=1, progress=lambda fraction, note: seen.append(fraction))
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_impossible_radio_is_an_answer(make_problem):
    """Out of reach of one another, the closest routes come back with what is wrong with them."""
    problem = make_problem(reach_m=np.full(4, 100.0))
    result = search(problem, SearchSettings(moves=20_000, starts=2), seed=1)
    assert not result.feasible
    assert result.assessment.totals["neighbours"] > 0
    assert sorted(node for route in result.routes for node in route) == list(range(24))


def _toy_floor(positions: np.ndarray, slot_s: float) -> np.ndarray:
    """Energy that grows with the square of the distance to the second nearest UAV."""
    distance = np.sort(pairwise_distances(positions), axis=2)[:, :, 2]
    return (distance[1:] ** 2).sum(axis=0) * slot_s * 1e-4


def test_energy_budget_is_kept(make_problem):
    """Where the shortest routes cost too much energy, others are found that do not."""
    free = search(make_problem(), QUICK, seed=4)
    spent = np.array(
        assess(make_problem(energy_j=np.ones(4), energy_floor=_toy_floor), free.routes).energy_j
    )
    budget = np.full(4, spent.max() * 0.9)
    problem = make_problem(energy_j=budget, energy_floor=_toy_floor)
    result = search(problem, QUICK, seed=4)
    assert result.feasible
    assert (np.array(result.assessment.energy_j) <= budget).all()


def test_no_energy_is_an_answer(make_problem):
    """A budget that nothing can keep is reported with the joules that are missing."""
    problem = make_problem(energy_j=np.full(4, 1e-3), energy_floor=_toy_floor)
    result = search(problem, SearchSettings(moves=40_000, starts=1), seed=4)
    assert not result.feasible
    assert result.assessment.energy_over_j > 0


def test_one_uav_flies_alone(make_problem):
    """One UAV with K_min 0 is an ordinary open path."""
    base = make_problem()
    problem = make_problem(
        starts_m=base.starts_m[:1],
        limits=base.limits[:1],
        t_max_s=np.array([600.0]),
        reach_m=base.reach_m[:1],
        k_min=0,
    )
    result = search(problem, SearchSettings(moves=40_000, starts=1), seed=1)
    assert result.feasible
    assert len(result.routes[0]) == 24


@pytest.mark.parametrize("uavs", [1, 3])
def test_a_single_waypoint_is_visited_by_who_is_near(uavs):
    """The kernel has no neighbour to move it to; everybody is tried."""
    starts = np.array([[60.0 * a, 0.0, 0.0] for a in range(uavs)])
    problem = RoutingProblem(
        np.array([[130.0, 0.0, 20.0]]), starts, np.array([900.0]), k_min=min(1, uavs - 1)
    )
    found = search(problem, SearchSettings(moves=1000), seed=0)
    assert found.feasible
    assert found.routes == (*((),) * (uavs - 1), (0,))
    late = search(replace(problem, t_max_s=np.array([2.0])), seed=0)
    assert not late.feasible
