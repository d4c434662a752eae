"""From nodes' diagnostics to what the conductor goes by."""

from __future__ import annotations

import pytest

from jfto.flight.fleet_status import GraphStatus, VehicleStatus
from jfto_msgs_py.ros.diagnostics import ERROR, OK, STALE, WARN, Diagnostics, Status

FACTS = {
    "link": "up",
    "silent_s": "0.4",
    "armed": "true",
    "mode": "AUTO",
    "waypoints_reached": "7",
    "late_s": "unknown",
}


def _bridge(*statuses: Status) -> Diagnostics:
    return Diagnostics("mavlink_bridge", 1, statuses)


def test_a_vehicle_is_seen_as_its_bridge_reports_it() -> None:
    """GraphStatus, armed, mode and waypoints; one that the bridge never heard is not there."""
    graph = GraphStatus(("uav1", "uav2"))
    graph.take(_bridge(Status("", OK, "linked"), Status("uav1", OK, "AUTO, armed", FACTS)))
    graph.take(Diagnostics("planner_node", 1, (Status("", OK, "12 waypoints"),)))
    fleet = graph.fleet(5.0, 50.0)
    assert fleet.uavs == {
        "uav1": VehicleStatus(True, 0.4, True, "AUTO", 7, None),
        "uav2": VehicleStatus(silent_s=0.0),
    }
    assert (fleet.note, fleet.planned, fleet.all_linked, fleet.all_down) == ("", True, False, False)


@pytest.mark.parametrize("facts", [{}, FACTS | {"link": "lost", "silent_s": "inf"}])
def test_a_bridge_that_came_back_has_to_listen_before_anybody_is_silent(facts) -> None:
    """What it has not heard yet may well fly: it is silent for as long as the bridge is there."""
    graph = GraphStatus(("uav1",))
    said = _bridge(Status("", OK, "linked"), Status("uav1", STALE, "never heard", facts))
    graph.take(said)
    assert graph.fleet(0.0, 100.0).uavs["uav1"].silent_s == 0.0
    assert graph.fleet(0.0, 107.0).uavs["uav1"].silent_s == 7.0
    graph.forget("mavlink_bridge")
    assert graph.fleet(0.0, 300.0).uavs == {}
    graph.take(said)
    assert graph.fleet(0.0, 305.0).uavs["uav1"].silent_s == 0.0


def test_without_a_bridge_nobody_is_seen() -> None:
    """Neither before it reports, nor while it is not linked, nor once it has died."""
    graph = GraphStatus(("uav1",))
    assert graph.fleet(0.0, 0.0).note == "the bridge has not reported yet"
    graph.take(_bridge(Status("", WARN, "not linked: opening its links"), Status("uav1", WARN, "")))
    assert graph.fleet(0.0, 0.0).note == "not linked: opening its links"
    graph.take(_bridge(Status("", OK, "linked"), Status("uav1", OK, "", FACTS)))
    assert graph.fleet(0.0, 0.0).all_linked
    graph.forget("mavlink_bridge")
    assert graph.fleet(0.0, 0.0).note == "the bridge has not reported yet"
    assert graph.fleet(0.0, 0.0).uavs == {}


@pytest.mark.parametrize(("level", "planned"), [(OK, True), (WARN, False), (ERROR, False)])
def test_a_plan_is_there_once_the_planner_says_so(level, planned) -> None:
    """A planner at work or in trouble has published nothing."""
    graph = GraphStatus(("uav1",))
    graph.take(Diagnostics("planner_node", 1, (Status("", level, "so it is"),)))
    assert graph.fleet(0.0, 0.0).planned is planned


def test_a_silent_vehicle_is_neither_heard_nor_down() -> None:
    """Disarmed as last heard of says nothing about now."""
    graph = GraphStatus(("uav1",))
    facts = FACTS | {"link": "lost", "silent_s": "31.0", "armed": "false"}
    graph.take(_bridge(Status("", OK, "linked"), Status("uav1", STALE, "silent", facts)))
    uav = graph.fleet(0.0, 0.0).uavs["uav1"]
    assert (uav.linked, uav.silent_s, uav.down) == (False, 31.0, False)
