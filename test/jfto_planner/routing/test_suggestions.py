"""Suggested cures have been tried, and are no larger than the closest plan needs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jfto_planner.routing import SearchSettings, search, suggest_cures
from jfto_planner.routing.assess import assess
from jfto_planner.routing.suggestions.changes import missing_gain_db, with_gain

QUICK = SearchSettings(moves=40_000, starts=1)


@pytest.fixture(name="hopeless")
def _hopeless(make_problem):
    """Problem whose radios reach too little, and the closest result."""
    problem = make_problem(reach_m=np.full(4, 110.0))
    return problem, search(problem, QUICK, seed=1)


def test_missing_gain_is_exactly_enough(hopeless):
    """The closest routes keep their links at the computed gain and lose one just below it."""
    problem, result = hopeless
    gain_db = missing_gain_db(problem, result.routes)
    assert gain_db > 0
    enough = assess(with_gain(problem, gain_db + 1e-6), result.routes)
    assert (enough.deficits, enough.splits, enough.fine_faults) == (0, 0, 0)
    less = assess(with_gain(problem, gain_db - 1e-3), result.routes)
    assert less.deficits + less.splits + less.fine_faults > 0


@pytest.mark.slow
def test_every_cure_has_been_tried(hopeless):
    """Each suggestion carries routes that are clean under it, and gain is among them."""
    problem, result = hopeless
    cures = suggest_cures(problem, result, seed=1, trial=QUICK)
    by_kind = {cure.kind: cure for cure in cures}
    gain = by_kind["gain"]
    assert gain.amount > 0
    assert assess(with_gain(problem, gain.amount), gain.routes).clean
    assert "dB" in gain.text
    if "k_min" in by_kind:
        easier = replace(problem, k_min=int(by_kind["k_min"].amount))
        assert assess(easier, by_kind["k_min"].routes).clean


def test_late_routes_are_cured_by_time(make_problem):
    """Where only time is missing, the seconds suggested make the closest routes clean."""
    problem = make_problem(t_max_s=np.full(4, 40.0), reach_m=np.full(4, 900.0), d_min_m=0.0)
    result = search(problem, QUICK, seed=1)
    assert not result.feasible
    times = [c for c in suggest_cures(problem, result, seed=1, trial=QUICK) if c.kind == "time"]
    assert len(times) == 1
    longer = replace(problem, t_max_s=problem.t_max_s + times[0].amount)
    assert assess(longer, result.routes).clean


def test_feasible_results_need_no_cure(make_problem):
    """A feasible result yields no suggestion."""
    problem = make_problem()
    result = search(problem, SearchSettings(moves=160_000, starts=2), seed=1)
    assert result.feasible
    assert suggest_cures(problem, result, seed=1, trial=QUICK) == ()


@pytest.mark.slow
def test_long_routes_are_cured_by_length(make_problem):
    """Where only length is missing, the closest routes are clean at the length suggested."""
    problem = make_problem(length_max_m=800.0, reach_m=np.full(4, 900.0), d_min_m=0.0)
    result = search(problem, QUICK, seed=1)
    assert not result.feasible
    by_kind = {c.kind: c for c in suggest_cures(problem, result, seed=1, trial=QUICK)}
    longer = replace(problem, length_max_m=by_kind["length"].amount)
    assert assess(longer, by_kind["length"].routes).clean


def test_no_search_begins_after_its_time(hopeless):
    """Without time there is what the closest routes show, and nothing that needs a search."""
    problem, result = hopeless
    told = []
    cures = suggest_cures(
        problem,
        result,
        seed=1,
        seconds=0.0,
        progress=lambda share, what: told.append((share, what)),
    )
    assert {cure.kind for cure in cures} <= {"time", "length", "energy", "separation", "gain"}
    assert told[0] == (0.0, "one budget more")


def test_one_more_uav_takes_off_over_the_same_ground(make_problem):
    """Legs that are closed at the pad beside it are closed for the further UAV too."""
    problem = make_problem(t_max_s=np.full(4, 60.0), reach_m=np.full(4, 900.0), d_min_m=5.0)
    closed = np.zeros((28, 28), dtype=bool)
    closed[24:, 0] = closed[0, 24:] = True
    problem = replace(problem, closed_legs=closed)
    result = search(problem, QUICK, seed=1)
    for cure in suggest_cures(problem, result, seed=1, trial=QUICK):
        if cure.kind == "uav":
            assert all(route[:1] != (0,) for route in cure.routes)
