"""The certificate sees every broken constraint, and nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jfto_msgs_py.errors import PlanError
from jfto_planner.routing import certify

# Sound routes of the small problem.
ROUTES = (
    (),
    (13, 2, 4, 22, 16, 23, 9, 10, 1),
    (15, 8, 19, 6, 5, 7, 0),
    (18, 3, 11, 14, 12, 21, 20, 17),
)


@pytest.fixture(name="plan")
def _plan(make_problem, make_plan):
    return make_plan(make_problem(), ROUTES)


def _kinds(plan, energy_floor=None):
    return {violation.kind for violation in certify(plan, energy_floor).violations}


def _with_uav(plan, index, **changes):
    uavs = list(plan.uavs)
    uavs[index] = replace(uavs[index], **changes)
    return replace(plan, uavs=tuple(uavs))


def test_sound_plan_is_clean(plan):
    """A plan that keeps every rule has a clean certificate with positive margins."""
    certificate = certify(plan, lambda positions, _slot_s: np.full(positions.shape[1], 99.0))
    assert certificate.clean
    assert certificate.violations == ()
    assert certificate.slot_checks == 4 * 41
    assert certificate.worst_margin_db > 0
    assert certificate.worst_separation_m >= plan.d_min_m
    assert certificate.energy_floor_j == (99.0,) * 4


@pytest.mark.parametrize(
    "routes",
    [
        (ROUTES[0], ROUTES[1][:-1], ROUTES[2], ROUTES[3]),
        (ROUTES[0], (*ROUTES[1], 1), ROUTES[2], ROUTES[3]),
    ],
    ids=["left out", "twice"],
)
def test_visits_are_counted(make_problem, make_plan, routes):
    """A waypoint visited never or twice is a visit violation naming its id, and the only one."""
    certificate = certify(make_plan(make_problem(), routes))
    (violation,) = certificate.violations
    assert violation.kind == "visit"
    assert "waypoint 101" in violation.message


def test_unknown_waypoint_is_a_visit_violation(plan):
    """An id that the plan has no waypoint for is reported, not crashed on."""
    fewer = replace(plan, waypoints=plan.waypoints[1:])
    messages = [violation.message for violation in certify(fewer).violations]
    assert "waypoint 100 is on a route and not in the plan" in messages


def test_separation_names_the_pair(plan):
    """Raising d_min just above the least distance yields separation violations of one pair."""
    least = certify(plan).worst_separation_m
    certificate = certify(replace(plan, d_min_m=least + 1e-6))
    assert {violation.kind for violation in certificate.violations} == {"separation"}
    assert "+" in certificate.violations[0].uav
    assert certificate.violations[0].value == pytest.approx(least)


def test_neighbours_are_counted_per_uav_and_slot(plan):
    """Asking for one neighbour more breaks the neighbour rule alone, at most in every check."""
    certificate = certify(replace(plan, k_min=3))
    assert {violation.kind for violation in certificate.violations} == {"neighbours"}
    at_slots = [v for v in certificate.violations if v.slot == int(v.slot)]
    assert len(at_slots) == certificate.slot_violations > 0
    assert certificate.worst_margin_db < 0


def test_weakest_uav_alone_loses_links(plan):
    """A link needs both powers: one weak UAV is short of neighbours on all its own links."""
    weak = certify(_with_uav(plan, 0, p_max_dbm=-20.0))
    assert "uav1" in {v.uav for v in weak.violations if v.kind == "neighbours"}
    assert "connected" in {violation.kind for violation in weak.violations}


def test_split_fleet_is_seen_without_neighbour_rule(plan):
    """With K_min 0 a fleet out of reach breaks connectivity alone."""
    silent = replace(plan, k_min=0, radio=replace(plan.radio, sensitivity_dbm=-40.0))
    certificate = certify(silent)
    assert {violation.kind for violation in certificate.violations} == {"connected"}
    assert certificate.worst_margin_db == np.inf


def test_duration_is_per_uav(plan):
    """Only the UAV whose time limit lies before its last arrival is late."""
    end = plan.routes[2].arrival_s[-1]
    certificate = certify(_with_uav(plan, 2, t_max_s=end - 0.01))
    assert [(v.kind, v.uav) for v in certificate.violations] == [("duration", "uav3")]


def test_horizon_shorter_than_the_routes_is_late(make_problem, make_plan):
    """With a given horizon, arriving after it is a duration violation."""
    certificate = certify(make_plan(make_problem(horizon_s=80.0), ROUTES))
    assert {violation.kind for violation in certificate.violations} == {"duration"}


def test_total_length_is_checked(plan):
    """Routes longer than L_max together are reported once."""
    certificate = certify(replace(plan, length_max_m=plan.total_length_m - 1e-3))
    assert [violation.kind for violation in certificate.violations] == ["total_length"]


@pytest.mark.parametrize("joules", [100.001, np.inf, np.nan])
def test_energy_floor_above_the_budget_is_a_violation(plan, joules):
    """A floor above E_max, or one that is no number, condemns that UAV alone."""
    certificate = certify(plan, lambda _positions, _slot_s: np.array([1.0, 2.0, joules, 100.0]))
    assert [(v.kind, v.uav) for v in certificate.violations] == [("energy", "uav3")]


def test_energy_floor_gets_time_first_positions(plan):
    """The energy floor is handed positions (N + 1, A, 3) and the slot's duration."""
    seen = []

    def floor(positions, slot_s):
        seen.append((positions.shape, slot_s))
        return np.zeros(4)

    certify(plan, floor)
    assert seen == [((41, 4, 3), plan.slots.duration_s)]


def test_moved_position_contradicts_its_route(plan):
    """A position off its route by a centimetre is a route violation naming UAV and slot."""
    moved = plan.positions_m.copy()
    moved[1, 7, 2] += 0.01
    certificate = certify(replace(plan, positions_m=moved))
    assert [(v.kind, v.uav, v.slot) for v in certificate.violations] == [("route", "uav2", 7)]


@pytest.mark.parametrize("field", ["arrival_s", "length_m"])
def test_wrong_times_and_lengths_contradict_the_route(plan, field):
    """An arrival or a length that the route does not have is a route violation."""
    route = plan.routes[3]
    wrong = {
        "arrival_s": {"arrival_s": (*route.arrival_s[:-1], route.arrival_s[-1] + 0.01)},
        "length_m": {"length_m": route.length_m - 0.01},
    }[field]
    routes = (*plan.routes[:3], replace(route, **wrong))
    certificate = certify(replace(plan, routes=routes))
    assert [(v.kind, v.uav) for v in certificate.violations] == [("route", "uav4")]


def test_faults_between_slots_are_found(make_problem, make_plan):
    """What happens only between the slots' instants is caught by the finer sampling."""
    ends = np.array([[0.0, 0.0, 50.0], [100.0, 0.0, 50.0]])
    base = make_problem()
    problem = make_problem(
        waypoints_m=ends[::-1],
        starts_m=ends,
        limits=(base.limits[0], base.limits[0]),
        t_max_s=base.t_max_s[:2],
        reach_m=base.reach_m[:2],
        k_min=1,
        slot_count=1,
    )
    certificate = certify(make_plan(problem, ((0,), (1,))))
    assert certificate.slot_violations == 0
    assert certificate.fine_violations == 1
    assert [(v.kind, v.slot) for v in certificate.violations] == [("separation", 0.5)]


def test_records_that_do_not_fit_are_an_error(plan):
    """Positions of the wrong shape or a missing route leave nothing to check."""
    with pytest.raises(PlanError, match="positions_m has shape"):
        certify(replace(plan, positions_m=plan.positions_m[:, :-1]))
    with pytest.raises(PlanError, match="3 routes for 4 UAVs"):
        certify(replace(plan, routes=plan.routes[:3]))
    short = replace(plan.routes[1], arrival_s=plan.routes[1].arrival_s[:-1])
    with pytest.raises(PlanError, match="uav2 has 8 arrivals for 9"):
        certify(replace(plan, routes=(plan.routes[0], short, *plan.routes[2:])))
