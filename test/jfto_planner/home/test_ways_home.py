"""Ways home: apart, above the ground, soon, and told truly by the certificate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.plan_file import plan_text, rounded
from jfto_planner.home import HomeRules, with_ways_home
from jfto_planner.home.plan_home import APART_S
from jfto_planner.routing import certify
from jfto_planner.routing.certificate import GroundRule
from jfto_planner.routing.certificate.home import STEP_S, home_places_m, home_times_s

CLEARANCE_M, RELIEF_M = 15.0, 80.0
MODELS = ("arducopter", "constant_speed", "bezier")


@pytest.fixture(name="homed", scope="module")
def _homed(make_fleet, make_hills):
    def make(count: int, seed: int, time_model: str = "arducopter"):
        """A plan with ways home, and the ground below it."""
        plan = make_fleet(count, seed, relief_m=RELIEF_M, time_model=time_model)
        ground = make_hills(seed, RELIEF_M)
        return rounded(with_ways_home(plan, HomeRules(ground, CLEARANCE_M))), ground

    return make


def _least_m(places: np.ndarray) -> float:
    """The least distance of any two at (T, A, 3)."""
    apart = np.linalg.norm(places[:, :, None] - places[:, None], axis=3)
    a, b = np.triu_indices(places.shape[1], 1)
    return float(apart[:, a, b].min())


@pytest.mark.slow
@settings(deadline=None, max_examples=40, derandomize=True)
@given(st.integers(2, 7), st.integers(0, 10_000), st.sampled_from(MODELS))
def test_everybody_keeps_apart_and_above_the_ground(homed, count, seed, time_model):
    """At ten times finer instants than the certificate's: d_min between all pairs, landing and
    standing included, and the clearance away from pads and last waypoints.
    """
    plan, ground = homed(count, seed, time_model)
    places = home_places_m(plan, home_times_s(plan, STEP_S / 10))
    assert _least_m(places) >= plan.d_min_m - 1e-3
    for a, uav in enumerate(plan.uavs):
        begin = plan.homes[a].line_m[0]
        away = np.hypot(*(places[:, a, :2] - np.array(uav.start_m)[:2]).T) > 3.0
        away &= np.hypot(*(places[:, a, :2] - begin[:2]).T) > 3.0
        above = places[away, a, 2] - ground(*places[away, a, :2].T)
        assert above.min(initial=np.inf) >= CLEARANCE_M - 0.05
        assert np.linalg.norm(places[-1, a] - np.array(uav.start_m)) < 1e-3


@pytest.mark.slow
@settings(deadline=None, max_examples=15, derandomize=True)
@given(st.integers(2, 5), st.integers(0, 10_000), st.data())
def test_a_uav_that_is_late_is_still_apart(homed, count, seed, data):
    """Any one UAV may leave two seconds after its time and keeps d_min all the same."""
    plan, _ = homed(count, seed)
    late = data.draw(st.integers(0, count - 1))
    times = home_times_s(plan, STEP_S)
    places = home_places_m(plan, times)
    places[:, late] = home_places_m(plan, times - APART_S)[:, late]
    assert _least_m(places) >= plan.d_min_m - 1e-3


@pytest.mark.parametrize("time_model", MODELS)
def test_the_certificate_agrees(homed, time_model):
    """Sound ways home are clean, and their figures are in the certificate."""
    plan, ground = homed(5, 3, time_model)
    found = certify(plan, home_ground=GroundRule(ground, CLEARANCE_M, CLEARANCE_M))
    assert [one.message for one in found.violations if one.kind in {"home", "endurance"}] == []
    assert found.home is not None
    assert found.home.landed_s == plan.landed_s == max(home.landed_s for home in plan.homes)
    assert found.home.worst_separation_m >= plan.d_min_m - 1e-3
    assert found.home.connected_share == found.home.neighbours_share == 1.0


def test_the_same_plan_gives_the_same_bytes(homed):
    """There is no chance in it, and the routes are left as they were."""
    (one, _), (other, _) = homed(6, 8), homed(6, 8)
    assert plan_text(one) == plan_text(other)
    assert plan_text(replace(one, homes=())) != plan_text(one)


def test_nobody_leaves_before_all_are_done(homed):
    """Every UAV holds at its last waypoint, in whole seconds, at least until the horizon."""
    plan, _ = homed(5, 11)
    for route, home in zip(plan.routes, plan.homes, strict=True):
        assert home.leave_s >= plan.slots.horizon_s - 1e-6
        assert home.leave_s == pytest.approx(route.end_s + home.hold_s, abs=1e-5)
        assert home.hold_s == round(home.hold_s) >= 1


def test_a_fleet_is_home_about_as_soon_as_its_farthest(homed):
    """One by one would take a multiple of it: waits and heights are chosen so that it does not."""
    plan, _ = homed(6, 5)
    alone = max(home.landed_s - home.leave_s for home in plan.homes)
    assert plan.landed_s is not None
    assert plan.landed_s - plan.slots.horizon_s < 1.5 * alone


def _with_home(plan, index, **changes):
    homes = list(plan.homes)
    homes[index] = replace(homes[index], **changes)
    return replace(plan, homes=tuple(homes))


def test_the_certificate_sees_what_is_wrong(homed):
    """Too near, too low, off its pad, before its time, timed wrongly, beyond the battery: each."""
    plan, ground = homed(4, 2)
    rule = GroundRule(ground, CLEARANCE_M, CLEARANCE_M)
    home = plan.homes[0]

    def said(broken) -> str:
        found = certify(broken, home_ground=rule).violations
        return "; ".join(one.message for one in found if one.kind in {"home", "endurance"})

    assert said(plan) == ""
    assert "m apart at" in said(replace(plan, d_min_m=40.0))
    low = tuple((x, y, z - 30.0) for x, y, z in home.points_m)
    assert "above the ground" in said(_with_home(plan, 0, points_m=(home.points_m[0], *low[1:])))
    off = (*home.points_m[:-1], (home.points_m[-1][0] + 5.0, *home.points_m[-1][1:]))
    assert "ends off its pad by 5.000 m" in said(_with_home(plan, 0, points_m=off))
    early = tuple(time - 20.0 for time in home.reached_s)
    assert "before all are done" in said(_with_home(plan, 0, reached_s=early))
    quick = (*home.reached_s[:-1], home.reached_s[-1] - 1.0)
    assert "timed off its legs" in said(_with_home(plan, 0, reached_s=quick))
    assert "sooner than it can land" in said(_with_home(plan, 0, landed_s=home.reached_s[-1]))
    uavs = (replace(plan.uavs[0], endurance_s=60.0), *plan.uavs[1:])
    assert "its battery lasts 60 s" in said(replace(plan, uavs=uavs))


def test_a_fleet_of_one_goes_home(homed):
    """It meets nobody: there is no least distance."""
    plan, ground = homed(1, 4)
    found = certify(plan, home_ground=GroundRule(ground, CLEARANCE_M, CLEARANCE_M))
    assert found.home is not None
    assert np.isnan(found.home.worst_separation_m)
    assert plan.homes[0].hold_s == 1.0
