"""The certificate's own look at no-fly zones, and plans round random ones."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.site import Fence, Polygon, Zone
from jfto_planner.home import HomeRules, with_ways_home
from jfto_planner.routing import (
    RoutingProblem,
    SearchSettings,
    build_plan,
    certify,
    plan_of,
    search,
    with_passed,
)
from jfto_planner.routing.build_plan import PlanTerms
from jfto_planner.routing.certificate.keep_out import check_keep_out
from jfto_planner.routing.detours import detours_of
from jfto_world.site.free_space import FreeSpace

RING = ((-20.0, -30.0), (20.0, -30.0), (20.0, 30.0), (-20.0, 30.0))
FIELD = ((-400.0, -400.0), (400.0, -400.0), (400.0, 400.0), (-400.0, 400.0))
PAD = np.array([[-100.0, 0.0, 0.0]])


def flown(fence: Fence, *waypoints: tuple[float, float, float]) -> Plan:
    """A plan of one UAV from west of the origin over waypoints, by constant speed."""
    problem = RoutingProblem(np.array(waypoints), PAD, np.array([900.0]), 0)
    return replace(plan_of(problem, [range(len(waypoints))]), fence=fence)


@pytest.mark.parametrize(
    ("zone", "value"),
    [
        (Zone("hut", RING), -19.5),
        (Zone("mast", (), (0.0, 8.0), 5.0), 3.0),
        (Zone("low", RING, bottom_m=None, top_m=39.0), None),
        (Zone("under", RING, bottom_m=None, top_m=41.0), -19.5),
        (Zone("high", RING, bottom_m=61.0), None),
        (Zone("beside", tuple((x, y + 34.0) for x, y in RING)), 4.0),
    ],
)
def test_the_least_room_is_found(zone, value):
    """A straight leg at 50 m through, beside, over and under zones, with a margin of 10 m."""
    plan = flown(Fence((), (zone,), 10.0), (-60.0, 0.0, 50.0), (100.0, 0.0, 50.0))
    found = check_keep_out(plan)
    if value is None:
        assert not found
        return
    (one,) = found
    assert (one.kind, one.uav) == ("keep_out", "uav1")
    assert one.value == pytest.approx(value, abs=0.6)
    assert zone.name in one.message
    assert one.time_s is not None


@pytest.mark.parametrize(
    ("part", "value"),
    [
        (Polygon(FIELD), None),
        (Polygon(tuple((0.2 * x, 0.2 * y) for x, y in FIELD)), 0.0),
        (Polygon(FIELD, (RING,)), -19.5),
        (Polygon(((-400.0, -4.0), (400.0, -4.0), (400.0, 400.0), (-400.0, 400.0))), 4.0),
    ],
)
def test_what_is_kept_in_is_not_left(part, value):
    """Leaving a polygon, coming near to its edge and entering its hole are told."""
    plan = flown(Fence((part,), (), 10.0), (-60.0, 0.0, 50.0), (100.0, 0.0, 50.0))
    found = check_keep_out(plan)
    assert len(found) == (value is not None)
    if value is not None:
        assert found[0].kind == "keep_in"
        assert found[0].value == pytest.approx(value, abs=0.6)


def test_the_way_home_counts():
    """A way home through a zone is broken where no rule kept it out, and kept where one did."""
    fence = Fence((), (Zone("hut", RING),), 5.0)
    around = ((-60.0, 0.0, 50.0), (-60.0, 90.0, 50.0), (100.0, 90.0, 50.0), (100.0, 0.0, 50.0))
    plan = flown(fence, *around)
    assert not check_keep_out(plan)
    through = with_ways_home(plan, HomeRules(lambda x, _: 0.0 * x, 15.0))
    assert [one.kind for one in check_keep_out(through)] == ["keep_out"]
    rules = HomeRules(lambda x, _: 0.0 * x, 15.0, FreeSpace(fence))
    assert not check_keep_out(with_ways_home(plan, rules))


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10_000))
def test_plans_round_random_zones_keep_out(seed):
    """Whatever the zones, a found plan keeps every zone and its area, at its true length and time.

    Places in zones and pairs without a way are named before.
    """
    rng = np.random.default_rng(seed)
    zones = tuple(
        Zone(f"z{k}", (), tuple(rng.uniform(-250, 250, 2).tolist()), float(rng.uniform(15, 80)))
        for k in range(5)
    )
    fence = Fence((Polygon(FIELD),), zones, 5.0)
    free = FreeSpace(fence)
    waypoints = np.column_stack([rng.uniform(-380, 380, (14, 2)), rng.uniform(40, 90, 14)])
    pads = np.column_stack([rng.uniform(-380, 380, (2, 2)), np.zeros(2)])
    waypoints = waypoints[~free.blocked(waypoints)]
    if free.blocked(pads).any() or len(waypoints) < 4:
        return
    detours, closed = detours_of(free, np.concatenate([waypoints, pads]), pads)
    problem = RoutingProblem(
        waypoints, pads, np.array([2000.0]), 1, closed_legs=closed, detours=detours
    )
    result = search(problem, SearchSettings(moves=20_000, starts=1), seed=1)
    plan = plan_of(problem, result.routes)
    passed, routes = with_passed(plan.waypoints, problem, result.routes)
    terms = PlanTerms(**{
        name: getattr(plan, name)
        for name in ("scenario_hash", "seed", "origin", "radio", "k_min", "delta", "d_min_m",
                     "length_max_m", "uavs")
    }, slot_count=150, horizon_s=None, waypoints=passed, fence=fence)  # fmt: skip
    built = build_plan(routes, terms)
    kinds = {one.kind for one in certify(built).violations}
    if result.assessment.low_legs:
        assert closed.any()
        return
    assert not kinds & {"keep_out", "keep_in", "route", "visit"}
    assert built.total_length_m == pytest.approx(result.length_m, abs=1e-3)
    assert built.photo_count == len(waypoints)
    assert max(route.end_s for route in built.routes) == pytest.approx(
        result.assessment.makespan_s, abs=1e-3
    )
