"""From nodes' diagnostics to what the conductor sees."""

from __future__ import annotations

import pytest

from jfto.conduct.heard import Heard
from jfto.conduct.seen import UavSeen
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
    """Heard, armed, mode and waypoints; one that the bridge never heard is not there."""
    heard = Heard(("uav1", "uav2"))
    heard.take(_bridge(Status("", OK, "linked"), Status("uav1", OK, "AUTO, armed", FACTS)))
    heard.take(Diagnostics("planner_node", 1, (Status("", OK, "12 waypoints"),)))
    seen = heard.seen(5.0, 50.0)
    assert seen.uavs == {"uav1": UavSeen(True, 0.4, True, "AUTO", 7), "uav2": UavSeen()}
    assert (seen.note, seen.planned, seen.all_heard, seen.all_down) == ("", True, False, False)


def test_without_a_bridge_nobody_is_seen() -> None:
    """Neither before it reports, nor while it is not linked, nor once it has died."""
    heard = Heard(("uav1",))
    assert heard.seen(0.0, 0.0).note == "the bridge has not reported yet"
    heard.take(_bridge(Status("", WARN, "not linked: opening its links"), Status("uav1", WARN, "")))
    assert heard.seen(0.0, 0.0).note == "not linked: opening its links"
    heard.take(_bridge(Status("", OK, "linked"), Status("uav1", OK, "", FACTS)))
    assert heard.seen(0.0, 0.0).all_heard
    heard.forget("mavlink_bridge")
    assert heard.seen(0.0, 0.0).note == "the bridge has not reported yet"
    assert heard.seen(0.0, 0.0).uavs == {}


@pytest.mark.parametrize(("level", "planned"), [(OK, True), (WARN, False), (ERROR, False)])
def test_a_plan_is_there_once_the_planner_says_so(level, planned) -> None:
    """A planner at work or in trouble has published nothing."""
    heard = Heard(("uav1",))
    heard.take(Diagnostics("planner_node", 1, (Status("", level, "so it is"),)))
    assert heard.seen(0.0, 0.0).planned is planned


def test_a_silent_vehicle_is_neither_heard_nor_down() -> None:
    """Disarmed as last heard of says nothing about now."""
    heard = Heard(("uav1",))
    facts = FACTS | {"link": "lost", "silent_s": "31.0", "armed": "false"}
    heard.take(_bridge(Status("", OK, "linked"), Status("uav1", STALE, "silent", facts)))
    uav = heard.seen(0.0, 0.0).uavs["uav1"]
    assert (uav.heard, uav.silent_s, uav.down) == (False, 31.0, False)
