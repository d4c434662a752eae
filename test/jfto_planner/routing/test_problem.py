"""Routing problems with wrong fields are refused with the field's name."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_planner.routing import SearchSettings, plan_of, search


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"waypoints_m": np.zeros((5, 2))}, r"waypoints_m has shape \(5, 2\)"),
        ({"waypoints_m": np.zeros((0, 3))}, "waypoints_m has shape"),
        ({"waypoints_m": np.array([[0, 0, 0], [0, np.nan, 0]])}, r"waypoints_m\[1\]"),
        ({"starts_m": np.zeros((65, 3))}, "starts_m has 65 pads"),
        ({"limits": ()}, "limits has 0 entries for 4 UAVs"),
        ({"t_max_s": np.array([1.0, 2, 3])}, r"t_max_s has shape \(3,\)"),
        ({"t_max_s": np.array([1.0, 2, 0, 3])}, r"t_max_s\[2\] is 0.0"),
        ({"reach_m": np.array([1.0, -2, 3, 3])}, r"reach_m\[1\] is -2.0"),
        ({"k_min": 4}, "4 UAVs can have at most 3 neighbours"),
        ({"k_min": -1}, "k_min is -1"),
        ({"k_min": 1.5}, "k_min is 1.5, must be a whole number"),
        ({"d_min_m": -1.0}, "d_min_m is -1.0"),
        ({"length_max_m": 0.0}, "length_max_m is 0.0"),
        ({"slot_count": 0}, "slot_count is 0"),
        ({"horizon_s": 0.0}, "horizon_s is 0.0"),
        ({"energy_j": np.ones(4)}, "energy_j and energy_floor must be given together"),
        ({"path_loss_exponent": 0.0}, "path_loss_exponent is 0.0"),
    ],
)
def test_wrong_field_is_named(make_problem, changes, message):
    """Each wrong shape or value raises InputError naming the field."""
    with pytest.raises(InputError, match=message):
        make_problem(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"moves": 0}, "moves is 0"),
        ({"moves": None}, "moves and search.time_limit_s are both None"),
        ({"starts": 0}, "starts is 0"),
        ({"time_limit_s": 0.0}, "time_limit_s is 0.0"),
        ({"workers": 0}, "workers is 0"),
        ({"ruin_share": 1.5}, "ruin_share is 1.5"),
        ({"coldest": 2.0, "hottest": 1.0}, "coldest is 2.0"),
    ],
)
def test_wrong_setting_is_named(changes, message):
    """Each wrong setting raises InputError naming it."""
    with pytest.raises(InputError, match=message):
        SearchSettings(**changes)


def test_pair_reach_is_the_lesser_range(make_problem):
    """A link must be closed by both ends, so the weaker one sets its reach."""
    problem = make_problem(reach_m=np.array([100.0, 300.0, 200.0, 300.0]))
    assert problem.pair_reach_m[1, 2] == 200.0
    assert problem.pair_reach_m[0, 3] == 100.0


@pytest.mark.parametrize(
    ("routes", "message"),
    [
        (((0, -1), (), (), ()), r"routes\[0\]\[1\] is -1, must be from 0 to"),
        (((), (99,), (), ()), r"routes\[1\]\[0\] is 99, must be from 0 to"),
        (((True,), (), (), ()), r"routes\[0\]\[0\] is True, must be a whole number"),
        (5, "routes is 5; give one sequence"),
        (((0,), 5, (), ()), r"routes\[1\] is 5, must be a sequence"),
        (((0,),), "routes has 1 entries for 4 UAVs"),
    ],
)
def test_routes_of_other_waypoints_make_no_plan(make_problem, routes, message):
    """Indices are those of waypoints that exist: none counts from the end."""
    with pytest.raises(InputError, match=message):
        plan_of(make_problem(), routes)


def test_whole_numbers_of_numpy_are_taken(make_problem):
    """What numpy counts is as good as what Python does."""
    problem = make_problem(k_min=np.int64(1))
    assert problem.k_min == 1
    routes = np.array_split(np.arange(problem.waypoint_count), 4)
    assert plan_of(problem, routes).routes[0].waypoint_ids[0] == 0


@pytest.mark.parametrize("seed", [-1, 2**40, "a", 1.5])
def test_wrong_seed_is_named(make_problem, seed):
    """The search refuses the seeds that a scenario refuses."""
    with pytest.raises(InputError, match="seed is"):
        search(make_problem(), seed=seed)
