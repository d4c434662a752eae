"""What is told of dangers and of the fleet, and when."""

from __future__ import annotations

import re

import numpy as np
import pytest

from jfto_msgs_py.records.event import ERROR, INFO, WARN
from jfto_msgs_py.records.vehicle import TimedTrajectory, VehiclePose
from jfto_topology.fleet_events import FleetEvents
from jfto_topology.flight_watch import FlightWatch
from jfto_topology.horizon import HorizonSettings, TopologyHorizon
from jfto_topology.links import Links
from jfto_world.motion.fleet_prediction import FleetPrediction
from jfto_world.radio import LogDistanceChannel
from support.fleets import START_NS, at

SLOTS, SLOT_S = 100, 2.0
SPEED_MPS, SPACING_M = 5.0, 60.0
IDS = ("uav1", "uav2", "uav3")


class _Flight:
    """Three UAVs one behind the other on one line, 60 m apart; radios reach 100 m."""

    def __init__(self) -> None:
        self.prediction = FleetPrediction()
        for index, uav in enumerate(IDS):
            begin = SPACING_M * index
            points = np.array([[begin, 0, 50], [begin + SPEED_MPS * 200, 0, 50]])
            offsets = np.array([0, 200 * 10**9])
            still = np.zeros((2, 3))
            plan = TimedTrajectory(START_NS, offsets, points, still, still)
            self.prediction.set_trajectory(uav, plan)
        links = Links(LogDistanceChannel(1.0), dict.fromkeys(IDS, 1.0), 1e-4, 1, 1)
        self.horizon = TopologyHorizon(
            self.prediction, links, HorizonSettings(SLOTS, SLOT_S, 10, 3.0, 0.2)
        )
        self.watch = FlightWatch(self.prediction, links, 10.0, 20)
        self.fleet_events = FleetEvents(self.prediction)
        self.left_j: dict[str, float] = {}
        self.told: list[tuple[float, int, str, str, str]] = []

    def measure(self, seconds: float, uav: str, reached_s: float) -> None:
        east_m = SPACING_M * IDS.index(uav) + SPEED_MPS * reached_s
        self.prediction.set_pose(uav, VehiclePose(at(seconds), (east_m, 0.0, 50.0), 90.0))

    def fly(self, begin_s: float, end_s: float, lags_s=lambda seconds: (0.0, 0.0, 0.0)) -> None:
        """Poses each 0.5 s with the lag of each UAV (None: no pose); slots solved when due."""
        for seconds in np.arange(begin_s, end_s, 0.5):
            for uav, lag_s in zip(IDS, lags_s(seconds), strict=True):
                if lag_s is not None:
                    self.measure(seconds, uav, seconds - lag_s)
            now_ns = at(seconds) + 1
            if not self.horizon.due(now_ns):
                continue
            found = self.horizon.solve(now_ns)
            if found is None:
                continue
            events = self.fleet_events.of_slot(found, now_ns)
            events += self.watch.look(found, SLOTS, now_ns, self.left_j)
            self.told += [
                (float(seconds), each.level, each.kind, each.uav_id, each.text) for each in events
            ]


def test_a_flight_as_planned_is_not_commented_on() -> None:
    """Nothing to tell from the pads to the end and beyond."""
    flight = _Flight()
    flight.left_j = dict.fromkeys(IDS, 1000.0)
    flight.fly(-3.0, 210.0)
    assert flight.told == []


def test_a_uav_that_loses_its_neighbours_is_told_before_it_does() -> None:
    """uav1 stands still from 20 s on: its neighbour, 60 m ahead, is out of reach 8 s later.

    Four seconds after it stopped that is known, four before it happens.
    """
    flight = _Flight()
    flight.fly(0.0, 40.0, lambda seconds: (max(seconds - 20.0, 0.0), 0.0, 0.0))
    flight.fly(40.0, 60.0, lambda seconds: (20.0 - (seconds - 40.0), 0.0, 0.0))
    flight.fly(60.0, 70.0)
    danger = [each for each in flight.told if each[2] == "k_min"]
    when, levels = [each[0] for each in danger], [each[1] for each in danger]
    assert levels == [WARN, INFO]
    assert danger[0][3] == "uav1"
    assert when[0] == 24.0
    assert re.match(
        r"uav1 has no 1. neighbour at full power in [45] s \(slot 14.\d\), up to [89].\d dB short;",
        danger[0][4],
    )
    assert "it was so for" in danger[1][4]


def test_a_coming_together_is_told_with_slot_and_lead() -> None:
    """uav2 stands still 60 m ahead of uav1: told 6 s before they are 10 m apart, and once."""
    flight = _Flight()
    flight.fly(0.0, 60.0)
    flight.fly(60.0, 72.0, lambda seconds: (0.0, seconds - 60.0, 0.0))
    danger = [each for each in flight.told if each[2] == "d_min"]
    assert [(each[0], each[1], each[3]) for each in danger] == [(64.0, WARN, "uav1+uav2")]
    assert re.match(
        r"uav1 and uav2 are closer than 10 m in [67] s \(slot 35.\d\), down to 0.\d m;",
        danger[0][4],
    )


def test_energy_is_reckoned_to_the_end_of_the_mission() -> None:
    """The whole rest counts, not the ten slots of the horizon; told ahead, once, and its end."""
    flight = _Flight()
    flight.left_j = {"uav1": 1000.0, "uav2": 30.0, "uav3": 1000.0}
    flight.fly(0.0, 10.0)
    assert [(each[0], each[1], each[2], each[3]) for each in flight.told] == [
        (0.0, WARN, "energy", "uav2")
    ]
    # 0.36 W for 60 m and 101 slots of 2 s cost 72.7 J, of which 30 J last for 41 slots.
    assert "from slot 41 on: 43 J short" in flight.told[0][4]
    flight.left_j["uav2"] = 900.0
    flight.fly(10.0, 20.0)
    assert [each[1] for each in flight.told] == [WARN, INFO]
    assert "it did not come to it" in flight.told[1][4]


def test_a_fleet_that_runs_late_shifts_its_slots_and_says_so() -> None:
    """Held up for 12 s from 20 s on, told in steps of 5 s; nobody is late within the fleet."""
    flight = _Flight()
    flight.fly(0.0, 60.0, lambda seconds: (min(max(seconds - 20.0, 0.0), 12.0),) * 3)
    texts = [each[4] for each in flight.told]
    assert all("its slots are shifted by as much" in text for text in texts)
    assert [each[2] for each in flight.told] == ["late", "late"]
    assert flight.horizon.slot == pytest.approx((60.0 - 12.0) / SLOT_S, abs=1)


def test_one_late_uav_keeps_its_own_lag() -> None:
    """12 s behind: told once and when it is over; the slots stay where they were planned."""
    flight = _Flight()
    flight.fly(0.0, 40.0, lambda seconds: (0.0, 0.0, min(max(seconds - 20.0, 0.0), 12.0)))
    late = [each for each in flight.told if each[2] == "late"]
    assert [(each[1], each[3]) for each in late] == [(WARN, "uav3")]
    assert "later than the fleet: it is predicted so" in late[0][4]
    assert flight.horizon.slot == 19
    assert flight.prediction.lag_s("uav3") == pytest.approx(12.0, abs=0.3)
    flight.fly(40.0, 60.0, lambda seconds: (0.0, 0.0, max(12.0 - (seconds - 40.0), 0.0)))
    late = [each for each in flight.told if each[2] == "late"]
    assert [each[1] for each in late] == [WARN, INFO]


def test_silence_of_one_and_of_all_is_told_and_blocks_no_slot() -> None:
    """uav3 falls silent, then all do, then all are back: a slot each 2 s all the while."""
    flight = _Flight()
    flight.fly(0.0, 10.0)
    flight.fly(10.0, 20.0, lambda seconds: (0.0, 0.0, None))
    flight.fly(20.0, 40.0, lambda seconds: (None, None, None))
    assert flight.horizon.slot == 19
    flight.fly(40.0, 50.0)
    stale = [(each[1], each[3]) for each in flight.told if each[2] == "stale"]
    assert stale == [(WARN, "uav3"), (ERROR, ""), (INFO, ""), (INFO, "uav3")]


def test_leaving_the_route_is_told_and_coming_back() -> None:
    """300 m aside for 10 s; it is then reckoned with where it is measured."""
    flight = _Flight()
    flight.fly(0.0, 20.0)
    for seconds in np.arange(20.0, 30.0, 0.5):
        flight.fly(seconds, seconds + 0.4, lambda _: (0.0, 0.0, None))
        pose = VehiclePose(at(float(seconds)), (200.0, 300.0, 50.0), 90.0)
        flight.prediction.set_pose("uav3", pose)
    assert flight.prediction.is_off_route("uav3")
    flight.fly(30.0, 40.0)
    texts = [each[4] for each in flight.told if each[3] == "uav3" and each[2] == "late"]
    assert texts == [
        "uav3 has left its route: it is reckoned with where it is measured.",
        "uav3 no longer strays from its route.",
    ]
