"""Suggested cures have been tried, and are no larger than the closest plan needs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jfto_planner.routing import SearchSettings, search, suggest_cures
from jfto_planner.routing.assess import assess
from jfto_planner.routing.cures import missing_gain_db, with_gain

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
