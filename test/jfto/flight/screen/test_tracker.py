"""What the tracker makes of a flight."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jfto.flight.screen import texts
from jfto.flight.screen.state import FLYING, HOLDING, LANDED, PAD, SILENT, UNHEARD, UNPLACED
from jfto.flight.screen.tracker import FlightTracker
from jfto.pipeline.run import Run
from jfto_msgs_py.records.event import WARN, Event
from jfto_msgs_py.records.network import Adjacency, SlotHorizon
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import VehiclePose
from jfto_planner.plan_trajectory import timed_trajectories
from jfto_world.motion.progress import sample

START_NS = 1_763_776_800 * 10**9


@pytest.fixture(scope="module")
def plan(tiny_run: tuple[Path, Run]) -> Plan:
    """The tiny scene's plan."""
    return tiny_run[1].plan


def _at(seconds: float) -> int:
    return START_NS + round(seconds * 1e9)


def _fly(tracker: FlightTracker, plan: Plan, until_s: float, late_s: float = 0.0) -> None:
    """Poses of the first UAV `late_s` behind the plan, of the others on it, four times a second."""
    trajectories = timed_trajectories(plan, START_NS)
    for clock in np.arange(0.0, until_s + 1e-6, 0.25):
        for index, (uav, one) in enumerate(trajectories.items()):
            time = clock - (late_s if index == 0 else 0.0)
            east, north, up = sample(one.offset_ns / 1e9, one.position_m, np.array([time]))[
                0
            ].tolist()
            tracker.take_pose(uav, VehiclePose(_at(float(clock)), (east, north, up), 0.0))


def test_a_fleet_on_its_pads_waits(plan: Plan) -> None:
    """Who was not heard is said to be so, others stand on their pads, nothing is late."""
    tracker = FlightTracker(plan, "tiny")
    tracker.take_pose("uav1", VehiclePose(_at(-9.0), plan.uavs[0].start_m, 0.0))
    state = tracker.state(_at(-8.0))
    assert [uav.phase for uav in state.uavs] == [PAD, UNHEARD, UNHEARD, UNHEARD]
    tracker.take_linked("uav2", linked=True)
    again = tracker.state(_at(-8.0))
    assert [uav.phase for uav in again.uavs] == [PAD, UNPLACED, UNHEARD, UNHEARD]
    assert state.doing == "waiting for lift-off"
    assert (state.clock_s, state.uavs[0].late_s, state.done) == (None, None, 0)


def test_a_late_uav_is_seen_to_be_late(plan: Plan) -> None:
    """Lateness comes from where it is, and its next waypoint is due that much later."""
    tracker = FlightTracker(plan, "tiny")
    tracker.take_lift_off(START_NS)
    middle = 0.5 * plan.slots.horizon_s
    _fly(tracker, plan, middle, late_s=4.0)
    first, second, *_ = tracker.state(_at(middle)).uavs
    assert first.late_s == pytest.approx(4.0, abs=0.5)
    assert second.late_s == pytest.approx(0.0, abs=0.3)
    assert first.phase == FLYING
    arrivals = np.array(plan.routes[0].arrival_s)
    assert first.done == (arrivals <= middle - 4.0).sum()
    assert first.next_in_s == pytest.approx(arrivals[first.done] + 4.0 - middle, abs=0.5)


def test_who_has_done_all_holds_and_who_is_silent_is_said_to_be(plan: Plan) -> None:
    """At the end all hold or fly; three seconds without a pose are silence; landed is landed."""
    tracker = FlightTracker(plan, "tiny")
    tracker.take_lift_off(START_NS)
    end = plan.slots.horizon_s + 0.5
    _fly(tracker, plan, end)
    assert {uav.phase for uav in tracker.state(_at(end)).uavs} == {HOLDING}
    assert tracker.state(_at(end)).done == 12
    tracker.take_event(Event(20, "landed", "uav1", "down", _at(end), "mavlink_bridge"))
    phases = [uav.phase for uav in tracker.state(_at(end + 4.0)).uavs]
    assert phases == [LANDED, SILENT, SILENT, SILENT]


def test_who_is_on_the_way_home_has_done_its_waypoints_and_is_not_late(plan: Plan) -> None:
    """Far from its route, a minute after its end: what was done stays done, and on time."""
    tracker = FlightTracker(plan, "tiny")
    tracker.take_lift_off(START_NS)
    end = plan.slots.horizon_s + 0.5
    _fly(tracker, plan, end)
    before = tracker.state(_at(end)).uavs[0]
    up_m = plan.uavs[0].start_m[2] + 40.0
    for second in range(1, 61):
        place = (3.0 * second, -2.0 * second, up_m)
        tracker.take_pose("uav1", VehiclePose(_at(end + second), place, 0.0))
    after = tracker.state(_at(end + 60.0)).uavs[0]
    assert (after.done, after.total) == (before.done, before.done)
    assert after.late_s == before.late_s == pytest.approx(0.0, abs=0.5)


def test_links_are_those_of_the_slot_with_what_they_can_lose(plan: Plan) -> None:
    """Two at 100 m: the weaker power less the path loss less the sensitivity, by hand."""
    tracker = FlightTracker(plan, "tiny")
    for index, (uav, east) in enumerate((("uav1", 0.0), ("uav2", 100.0), ("uav3", 200.0))):
        tracker.take_pose(uav, VehiclePose(_at(0.0), (east, 0.0, 50.0), 0.0))
        tracker.take_power(uav, 20.0 + index, _at(0.0))
    state = tracker.state(_at(0.0))
    radio = plan.radio
    loss_db = 20 * np.log10(4 * np.pi * 100.0 * radio.frequency_hz / 299_792_458.0)
    gains_db = radio.gain_tx_dbi + radio.gain_rx_dbi - radio.fade_margin_db
    expected = 20.0 + gains_db - loss_db - radio.sensitivity_dbm
    assert state.uavs[0].links[0].spare_db == pytest.approx(expected, abs=1e-6)
    assert state.parts == 1
    links = np.zeros((2, 4, 4), dtype=np.bool_)
    links[1, 0, 2] = links[1, 2, 0] = True
    ids = ("uav1", "uav2", "uav3", "uav4")
    tracker.take_adjacency(Adjacency(SlotHorizon(4, _at(0.0), 2.0, 2), ids, links))
    later = tracker.state(_at(2.5))
    assert [link.peer for link in later.uavs[0].links] == ["uav3"]
    assert later.slot == 5


def test_energy_is_charged_from_lift_off(plan: Plan) -> None:
    """1 W for 30 s costs 30 J."""
    tracker = FlightTracker(plan, "tiny")
    tracker.take_power("uav1", 30.0, _at(-60.0))
    tracker.take_lift_off(START_NS)
    assert tracker.state(_at(30.0)).uavs[0].energy_left_j == pytest.approx(200.0 - 30.0)


def test_events_are_taken_once_and_timed_from_lift_off(plan: Plan) -> None:
    """A latched event that comes again, as after a restart, is not shown twice."""
    tracker = FlightTracker(plan, "tiny")
    event = Event(WARN, "energy", "uav2", "uav2 runs short", _at(12.0), "power_node")
    tracker.take_event(event)
    tracker.take_event(event)
    before = tracker.state(_at(20.0))
    assert texts.event(before.events[0], before.lift_off_ns).plain.startswith("--:-- !")
    tracker.take_lift_off(START_NS)
    after = tracker.state(_at(20.0))
    (shown,) = after.events
    assert texts.event(shown, after.lift_off_ns).plain == "00:12 ! uav2 runs short"


def test_what_the_autopilot_reports_counts_where_poses_tell_of_less(plan: Plan) -> None:
    """At a time gate a UAV stands still with its waypoint reached, and is no later for that."""
    tracker = FlightTracker(plan, "tiny")
    tracker.take_lift_off(START_NS)
    arrivals = plan.routes[0].arrival_s
    _fly(tracker, plan, 1.0, late_s=1.0)
    tracker.take_reached("uav1", len(arrivals), 0.4)
    uav = tracker.state(_at(1.0)).uavs[0]
    assert (uav.done, uav.late_s, uav.next_in_s) == (len(arrivals), 0.4, None)
    tracker.take_reached("uav2", 1, 5.0)
    assert tracker.state(_at(1.0)).uavs[1].done == 1
