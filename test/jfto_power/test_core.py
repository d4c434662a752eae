"""The power core: schedules, setpoints and the energy account, on a clock of the tests."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_msgs_py.core import CoreRun
from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event
from jfto_msgs_py.records.network import Adjacency, PowerIntervals, PowerSchedule, SlotHorizon
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_msgs_py.ros import diagnostics
from jfto_power.core import PowerCore, PowerOutputs
from jfto_power.energy_account import EnergyAccount
from jfto_power.horizon import HorizonRules
from jfto_power.node.statuses import about_fleet, about_uav
from jfto_world.radio import make_channel
from support.fleets import at, eastward, pose

IDS = ("uav1", "uav2", "uav3")
DURATION_S = 2.0
SLOTS = 10


class _Flight:
    """A core of three UAVs with a plan, and a topology beside it: a chain, 10 mW to 1 W."""

    def __init__(self, energy_j: float = 8.0, served: tuple[str, ...] | None = None) -> None:
        account = EnergyAccount(dict.fromkeys(IDS, energy_j))
        self.core = PowerCore(HorizonRules(SLOTS, make_channel(Radio()), Radio()), account, served)
        self.account = account
        self.run = CoreRun(self.core, at(-60.0), self._take)
        self.schedules: list[PowerSchedule] = []
        self.setpoints_w: dict[str, list[float]] = {uav: [] for uav in IDS}
        self.left_j: list[dict[str, float]] = []
        self.told: list[Event] = []
        for index, uav in enumerate(IDS):
            self.plan(uav, eastward(100.0 * index))

    def _take(self, _now_ns: int, made: PowerOutputs) -> None:
        self.schedules += [] if made.schedule is None else [made.schedule]
        for uav, power_w in made.setpoints_w.items():
            self.setpoints_w[uav].append(power_w)
        self.left_j += [made.left_j] if made.left_j else []
        self.told += made.events

    def at(self, seconds: float) -> None:
        self.run.advance(at(seconds))

    def plan(self, uav: str, trajectory: TimedTrajectory) -> None:
        self.run.hand_over(
            lambda each, now_ns: self.core.take_trajectory(uav, each, now_ns), trajectory
        )

    def topology(self, first: int, count: int = 4, ids: tuple[str, ...] = IDS) -> None:
        fleet = len(ids)
        links = np.zeros((count, fleet, fleet), dtype=bool)
        for left, right in zip(range(fleet - 1), range(1, fleet), strict=True):
            links[:, [left, right], [right, left]] = True
        bounds = np.broadcast_to([0.01, 1.0], (count, fleet, 2)).copy()
        horizon = _horizon(first, count)
        self.give(Adjacency(horizon, ids, links), PowerIntervals(horizon, ids, bounds))

    def give(self, adjacency: Adjacency | None, intervals: PowerIntervals | None) -> None:
        if adjacency is not None:
            self.run.hand_over(self.core.take_adjacency, adjacency)
        if intervals is not None:
            self.run.hand_over(self.core.take_intervals, intervals)

    def events(self, kind: str) -> list[Event]:
        return [event for event in self.told if event.kind == kind]

    def powers_w(self) -> list[float]:
        return [self.account.power_w[uav] for uav in IDS]

    def status(self, uav: str = "") -> diagnostics.Status:
        if uav:
            return about_uav(self.core, uav, {})
        return about_fleet(self.core, {"allocation": self.core.trouble}, {}, self.run.now_ns)


def _horizon(first: int, count: int) -> SlotHorizon:
    return SlotHorizon(first, at(first * DURATION_S), DURATION_S, count)


def test_powers_keep_to_their_intervals_and_the_energys_share() -> None:
    """Four of eleven slots may use 4/11 of the energy; the setpoint is the first row."""
    flight = _Flight()
    flight.at(0.1)
    flight.topology(0)
    (schedule,) = flight.schedules
    assert schedule.uav_ids == IDS
    assert (schedule.power_w >= 0.01).all()
    assert (schedule.power_w <= 1.0).all()
    assert schedule.power_w.sum(axis=0).max() * DURATION_S <= 8.0 * 4 / 11 * (1 + 1e-9)
    assert [flight.setpoints_w[uav] for uav in IDS] == [[power] for power in schedule.power_w[0]]


def test_half_a_pair_solves_nothing() -> None:
    """Adjacency of one slot and intervals of another are not of one horizon."""
    flight = _Flight()
    flight.at(0.1)
    flight.topology(0)
    links = np.zeros((2, 3, 3), dtype=bool)
    flight.give(Adjacency(_horizon(1, 2), IDS, links), None)
    flight.at(2.1)
    assert len(flight.schedules) == 1
    flight.topology(2, 1)
    assert len(flight.schedules) == 2
    assert flight.schedules[-1].horizon.first == 2


def test_a_silent_topology_stops_no_setpoint() -> None:
    """The last schedule goes on row by row; diagnostics tell of the silence."""
    flight = _Flight(energy_j=3.0)
    flight.at(0.1)
    flight.topology(0)
    (schedule,) = flight.schedules
    for slot in (1, 2, 3):
        flight.at(slot * DURATION_S + 0.1)
        assert np.allclose(flight.powers_w(), schedule.power_w[slot])
    assert "topology silent" in flight.status().text
    assert np.allclose(flight.powers_w(), schedule.power_w[3])


def test_cores_of_single_uavs_agree_with_one_for_all() -> None:
    """Each solves the whole problem, so that its row is the fleet's; all use the same energy."""
    whole = _Flight()
    whole.at(0.1)
    whole.topology(0)
    for index, uav in enumerate(IDS):
        alone = _Flight(served=(uav,))
        alone.at(0.2)
        alone.topology(0)
        (schedule,) = alone.schedules
        assert schedule.uav_ids == (uav,)
        assert np.allclose(schedule.power_w[:, 0], whole.schedules[0].power_w[:, index], rtol=1e-3)


def test_a_topology_of_strangers_is_refused() -> None:
    """It names a UAV that there is none of; the next good pair is solved."""
    flight = _Flight()
    flight.at(0.1)
    with pytest.raises(MessageError, match="ghost not in the scenario"):
        flight.topology(0, ids=("uav1", "uav2", "ghost"))
    flight.topology(1)
    assert flight.schedules[-1].uav_ids == IDS


def test_a_pose_from_the_future_is_refused() -> None:
    """More than a second ahead of the clock it would hide those that come after it."""
    flight = _Flight()
    flight.at(0.0)
    flight.core.take_pose("uav1", pose(0.9, 0.0, 0.0), at(0.0))
    with pytest.raises(MessageError, match=r"header\.stamp: is 1\.5 s ahead of this clock"):
        flight.core.take_pose("uav1", pose(1.5, 0.0, 0.0), at(0.0))


def test_a_shortage_is_told() -> None:
    """Where the least powers cost more than is left, diagnostics name the UAVs."""
    flight = _Flight(energy_j=0.01)
    flight.at(0.1)
    flight.topology(0)
    status = flight.status()
    assert status.level == diagnostics.ERROR
    assert "uav1" in status.text
    assert len(flight.events("energy")) == 3
    event = flight.events("energy")[0]
    assert (event.level, event.uav_id) == (WARN, "uav1")
    assert event.text == (
        "uav1 lacks 0.07 J for the least powers of its topology: it is held until slot 0 and "
        "silent then, the others go on."
    )


def test_silence_of_the_topology_is_told_once_and_its_end() -> None:
    """Two slots without a topology: WARN; past the horizon: ERROR; there again: over."""
    flight = _Flight()
    flight.at(0.1)
    flight.topology(0)
    flight.at(4.1)
    assert flight.events("topology") == []
    flight.at(4.2)
    assert [event.level for event in flight.events("topology")] == [WARN]
    flight.at(9.7)
    assert len(flight.events("topology")) == 2
    flight.topology(5)
    assert len(flight.schedules) == 2
    assert [event.level for event in flight.events("topology")] == [WARN, ERROR, INFO]


def test_a_radio_whose_energy_is_used_up_is_put_to_silence_at_once() -> None:
    """The last row stays in force beyond its slot until 0.5 J are gone; never below zero."""
    flight = _Flight(energy_j=0.5)
    flight.at(0.0)
    flight.topology(10, 1)
    assert flight.schedules[0].power_w[0].tolist() == [0.01, 0.01, 0.01]
    flight.at(30.0)
    assert not flight.events("energy")
    flight.at(50.0)
    assert len(flight.events("energy")) == 3
    assert all(setpoints == [0.01, 0.0] for setpoints in flight.setpoints_w.values())
    assert max(flight.account.left_j.values()) < 1e-6
    assert flight.events("energy")[0].level == ERROR


def test_nothing_is_charged_on_the_pads() -> None:
    """Setpoints are in force before time zero, and their energy is not counted."""
    flight = _Flight()
    flight.at(-30.0)
    flight.topology(0)
    flight.at(0.0)
    flight.topology(0, 3)
    assert len(flight.schedules) == 2
    assert flight.left_j[-1] == {"uav1": 8.0, "uav2": 8.0, "uav3": 8.0}


def test_a_late_joiner_begins_in_the_slot_that_is_on() -> None:
    """A core that hears of slots 0 to 3 in slot 2 schedules slots 2 and 3, and pays for those."""
    flight = _Flight()
    flight.at(4.5)
    flight.topology(0)
    horizon = flight.schedules[-1].horizon
    assert (horizon.first, horizon.count, horizon.t0_ns) == (2, 2, at(4.0))


def test_a_topology_of_fewer_uavs_leaves_the_others_their_power() -> None:
    """Two of three are scheduled anew; the third keeps its setpoint, and diagnostics say so."""
    flight = _Flight()
    flight.at(0.1)
    flight.topology(0)
    before_w = flight.account.power_w["uav3"]
    two = ("uav1", "uav2")
    links = np.broadcast_to(~np.eye(2, dtype=bool), (4, 2, 2)).copy()
    bounds = np.broadcast_to([0.02, 0.03], (4, 2, 2)).copy()
    flight.at(2.1)
    flight.give(Adjacency(_horizon(1, 4), two, links), PowerIntervals(_horizon(1, 4), two, bounds))
    assert len(flight.schedules) == 2
    assert flight.schedules[-1].uav_ids == two
    assert flight.account.power_w["uav1"] == pytest.approx(0.03)
    assert flight.account.power_w["uav3"] == before_w
    assert "not part of the schedule" in flight.status("uav3").text


def test_stepping_more_often_changes_nothing() -> None:
    """A timer that fires twice tells nothing twice, and puts the same powers in force."""
    once, twice = _Flight(energy_j=0.5), _Flight(energy_j=0.5)
    for flight in (once, twice):
        flight.at(0.1)
        flight.topology(0)
        for tenth in range(300):
            flight.at(0.1 + 0.1 * tenth)
            for _ in range(2 if flight is twice else 0):
                flight.run.step()
    assert twice.setpoints_w == once.setpoints_w
    assert [event.text for event in twice.told] == [event.text for event in once.told]
    assert twice.account.left_j == pytest.approx(once.account.left_j)
