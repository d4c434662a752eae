"""Whether routes fit into the missions of an autopilot."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.limits import MissionLimits
from jfto_mavlink.mission.settings import MissionSettings
from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.plan import Origin, Plan, Route, Slots, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_planner.routing.certificate.mission_size import (
    ITEMS_MAX,
    check_mission_size,
    mission_items,
    most_photos,
)

TINY = Path(__file__).parents[3] / "data/scenario/tiny.yaml"


def plan_of(*photos: int) -> Plan:
    """A UAV for each count of photos, on a line above its pad."""
    ids = np.split(np.arange(sum(photos)), np.cumsum(photos)[:-1])
    waypoints = tuple(Waypoint(k, (float(k), 0.0, 50.0), 10.0, -80.0) for k in range(sum(photos)))
    uavs = tuple(
        Uav(f"uav{n + 1}", 30.0, 200.0, 9000.0, 8.0, 4.0, 3.0, (0.0, 20.0 * n, 0.0))
        for n in range(len(photos))
    )
    routes = tuple(Route(tuple(map(int, own)), tuple(10.0 + own), 1.0) for own in ids)
    shape = (len(photos), 11, 3)
    return Plan(
        "0" * 64, 1, Origin(47.0, 8.0, 500.0), Radio(), 0, 1, 5.0, 1e6, Slots(10, 300.0),
        waypoints, uavs, routes, np.zeros(shape),
    )  # fmt: skip


@pytest.mark.parametrize("photos", [1, 7, 100])
def test_the_count_is_that_of_missions_as_built(photos):
    """No mission has more items than are counted, and at most the climb home fewer."""
    plan = plan_of(photos, 3)
    for index, built in enumerate(build_missions(plan, MissionSettings())):
        assert 0 <= mission_items(plan, index) - len(built.mission.items) <= 1


def test_the_limit_is_that_of_missions():
    """Both are told of the same board."""
    assert MissionLimits().items_max == ITEMS_MAX


def test_a_route_that_no_autopilot_holds_is_a_violation():
    """UAV, items and cure are named; a UAV that can hold its own is not."""
    (found,) = check_mission_size(plan_of(261, most_photos()))
    assert (found.kind, found.uav, found.value, found.limit) == ("items", "uav1", 1052, 650)
    assert "fleet.count" in found.message


def test_waypoints_that_fit_no_division_are_refused_before_the_search():
    """Two UAVs and 380 waypoints: three are needed, and that is said."""
    wanted = ["waypoints.count=380", "fleet.count=2", "fleet.p_max_dbm=29", "fleet.energy_j=9000"]
    wanted += ["network.k_min=1"]
    loaded = load_scenario(TINY, wanted)
    with pytest.raises(InfeasibleError, match=r"380 waypoints do not fit .* 2 UAVs") as caught:
        plan_routes(loaded.scenario, survey(loaded))
    assert "fleet.count of 3 or more" in caught.value.cures


def test_a_plan_checked_again_names_it_too():
    """The rule is of the certificate, so that `jfto check` knows it."""
    from jfto_planner.routing import certify

    plan = dataclasses.replace(plan_of(200), time_model="constant_speed")
    assert "items" in {violation.kind for violation in certify(plan).violations}
