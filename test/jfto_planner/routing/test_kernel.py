"""Incremental evaluation in the kernels agrees with evaluation from scratch and with numpy."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_planner.routing.annealer import Annealer, _put_routes, _routes
from jfto_planner.routing.assess import assess
from jfto_planner.routing.kernel.anneal import anneal
from jfto_planner.routing.settings import SearchSettings

SETTINGS = SearchSettings(moves=1000, starts=1)


def _annealed(problem, seed, moves, temperature=50.0, ruin_share=0.3):
    annealer = Annealer(problem, SETTINGS, seed, None)
    anneal(annealer.tables, annealer.search, moves, temperature, ruin_share, True)
    return annealer


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("reach", [60.0, 200.0])
def test_state_after_many_moves_is_what_its_routes_say(make_problem, seed, reach):
    """After thousands of moves every cached figure equals that of the same routes, loaded anew."""
    problem = make_problem(seed, reach_m=np.array([1, 1.1, 1.2, 1.3]) * reach, d_min_m=15.0)
    worked = _annealed(problem, seed, 5000)
    state = worked.search.cur
    fresh = Annealer(problem, SETTINGS, 1, _routes(state))
    fresh.search.weights[:] = worked.search.weights
    # The shipped move count is the least that evaluates: at no temperature nothing else is taken.
    anneal(fresh.tables, fresh.search, 1, 0.0, 0.0, True)
    again = fresh.search.cur
    assert _routes(again) == _routes(state)
    np.testing.assert_allclose(again.total, state.total, rtol=1e-12, atol=1e-9)
    np.testing.assert_array_equal(again.pos, state.pos)
    np.testing.assert_array_equal(again.mask, state.mask)
    np.testing.assert_allclose(again.deficit, state.deficit, rtol=1e-12)
    np.testing.assert_array_equal(again.route_of, state.route_of)
    np.testing.assert_array_equal(again.index_of, state.index_of)


@pytest.mark.parametrize("ruin_share", [0.0, 1.0])
def test_moves_keep_every_waypoint_once(make_problem, ruin_share):
    """Local moves and ruin and recreate neither lose nor double a waypoint."""
    annealer = _annealed(make_problem(), 3, 20_000, ruin_share=ruin_share)
    nodes = sorted(node for route in _routes(annealer.search.cur) for node in route)
    assert nodes == list(range(24))


def test_total_length_is_the_sum_of_legs(make_problem):
    """The kernel's length is that of its routes, measured in numpy."""
    problem = make_problem(2)
    annealer = _annealed(problem, 1, 3000)
    measured = assess(problem, _routes(annealer.search.cur)).length_m
    assert annealer.search.cur.total[0] == pytest.approx(measured, abs=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_kept_routes_are_sound_by_the_exact_definitions(make_problem, seed):
    """Whatever the kernel keeps as best passes the exact check with the time model."""
    problem = make_problem(seed, d_min_m=8.0)
    annealer = _annealed(problem, seed, 20_000, temperature=20.0)
    best = annealer.search.best
    if np.isfinite(best.total[0]):
        assert assess(problem, _routes(best)).clean
    else:
        assert annealer.search.violated[0] > 0.0


def test_given_routes_are_the_first_state(make_problem):
    """Routes put into a state are evaluated as they are."""
    annealer = Annealer(make_problem(), SETTINGS, 1, None)
    routes = tuple(tuple(range(a, 24, 4)) for a in range(4))
    _put_routes(annealer.search.cur, routes)
    anneal(annealer.tables, annealer.search, 1, 0.0, 0.0, True)
    assert _routes(annealer.search.cur) == routes
