"""The topology core: what it makes of plans, poses and radios, on a clock of the tests."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from jfto_msgs_py.core import CoreRun
from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.air import AirArray
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.ros import diagnostics
from jfto_msgs_py.units import dbm_to_w
from jfto_sim.air import Air, AirMember, AirSettings
from jfto_topology.core import TopologyCore, TopologyOutputs, TopologySettings
from jfto_topology.horizon import HorizonTopology
from jfto_topology.links import Links
from jfto_topology.node.statuses import about_fleet, about_uav
from jfto_topology.options import TopologyOptions
from jfto_world.radio import make_channel
from support.fleets import START_NS, at, eastward, pose

IDS = ("uav1", "uav2", "uav3")
SLOTS = 10


class _Flight:
    """A core of three UAVs that fly east, 100 m apart, for 20 s: ten slots of 2 s."""

    def __init__(self, begin_s: float = 0.0) -> None:
        links = Links(
            make_channel(Radio()),
            dict.fromkeys(IDS, 1.0),
            float(dbm_to_w(Radio().sensitivity_dbm)),
            1,
            1,
            TopologyOptions().margin_db,
        )
        options = TopologyOptions(horizon_slots=4)
        self.core = TopologyCore(TopologySettings(links, SLOTS, 0.0, 5.0, options))
        self.solved: list[HorizonTopology] = []
        self.told: list[Event] = []
        self.restart(begin_s)

    def restart(self, seconds: float) -> None:
        """A new core in place of the one there was; it gets the plans that were kept."""
        self.core = TopologyCore(self.core.settings)
        self.run = CoreRun(self.core, at(seconds), self._take)
        for index, uav in enumerate(IDS):
            self.run.hand_over(partial(self.core.take_trajectory, uav), eastward(100.0 * index))

    def _take(self, now_ns: int, made: TopologyOutputs) -> None:
        self.solved += [] if made.solved is None else [made.solved]
        self.told += self.core.review(now_ns)

    def at(self, seconds: float) -> None:
        self.run.advance(at(seconds))

    def measure(self, seconds: float, *uavs: str, lag_s: float = 0.0) -> None:
        """Poses as planned, `lag_s` late, given as soon as they are measured."""
        for uav in uavs:
            north_m = 100.0 * IDS.index(uav)
            where = pose(seconds, 5.0 * (seconds - lag_s), north_m)
            self.run.hand_over(partial(self.core.take_pose, uav), where)

    def firsts(self) -> list[int]:
        return [solved.adjacency.horizon.first for solved in self.solved]

    def least_w(self) -> float:
        """Least power of the first UAV in the current slot of the latest topology."""
        return float(self.solved[-1].intervals.bounds_w[0, 0, 0])

    def status(self, uav: str = "") -> diagnostics.Status:
        if not uav:
            return about_fleet(self.core, {})
        margins_db = self.core.margins_db(self.solved[-1])
        return about_uav(self.core, uav, margins_db, {}, self.run.now_ns)


def test_a_late_pose_is_waited_for_until_the_deadline() -> None:
    """Nothing before pose_wait_s has passed; then the slot comes with all UAVs in it."""
    flight = _Flight(1.9)
    flight.measure(1.9, *IDS)
    assert flight.firsts() == [0]
    flight.at(2.1)
    flight.measure(2.1, "uav1", "uav2")
    flight.at(2.15)
    assert flight.firsts() == [0]
    flight.at(2.25)
    assert flight.firsts() == [0, 1]
    assert flight.solved[-1].adjacency.uav_ids == IDS


def test_a_stale_uav_is_excluded_and_flagged() -> None:
    """A UAV that is not heard of any more leaves the topology, and diagnostics say why."""
    flight = _Flight()
    flight.at(2.1)
    flight.measure(2.1, *IDS)
    assert flight.solved
    flight.at(6.1)
    flight.measure(6.1, "uav1", "uav2")
    flight.at(6.3)
    assert flight.firsts()[-1] == 3
    assert flight.solved[-1].adjacency.uav_ids == ("uav1", "uav2")
    flight.at(7.4)
    assert "excluded" in flight.status("uav3").text
    assert flight.status("uav3").level == diagnostics.STALE
    assert float(flight.status("uav1").facts["margin_db"]) > 0


def test_a_core_restarted_in_mid_flight_goes_on_within_a_slot() -> None:
    """It gets the kept plans, finds a lag of 11 s from one pose each, and the slot they are in.

    The plan lasts 20 s, its ten slots 2 s each: at 16.5 s, 11 s late, the fleet is in slot 2.
    """
    flight = _Flight()
    flight.at(2.1)
    flight.measure(2.1, *IDS)
    assert flight.firsts() == [1]
    flight.restart(16.5)
    flight.measure(16.5, *IDS, lag_s=11.0)
    horizon = flight.solved[-1].adjacency.horizon
    assert len(flight.solved) == 2
    assert horizon.first == 2
    assert abs(horizon.t0_ns - at(15.0)) < 10**8
    assert any("11 s late: its slots are shifted" in event.text for event in flight.told)
    assert float(flight.status().facts["slot_shift_s"]) > 10
    assert float(flight.status().facts["fleet_lag_s"]) == pytest.approx(11.0, abs=0.1)


def test_silence_of_all_blocks_no_slot_and_is_told() -> None:
    """Four seconds without a pose: the topology of all UAVs goes on, announced as an error."""
    flight = _Flight()
    flight.at(2.1)
    flight.measure(2.1, *IDS)
    assert flight.firsts() == [1]
    flight.at(8.7)
    assert len(flight.solved) >= 3
    assert flight.solved[-1].adjacency.uav_ids == IDS
    event = flight.told[0]
    assert (event.level, event.kind, event.uav_id) == (ERROR, "stale", "")
    assert "from their last good predictions" in event.text
    flight.at(10.05)
    flight.measure(10.05, *IDS)
    assert len(flight.told) == 2
    assert flight.told[1].level == INFO


def test_energy_that_will_not_last_is_announced_before() -> None:
    """The power node's account against the least powers of all slots that are left."""
    flight = _Flight()
    left_j = {"uav1": 1e-6, "uav2": 50.0, "uav3": 50.0}
    flight.run.hand_over(flight.core.take_energy, left_j)
    flight.at(2.1)
    flight.measure(2.1, *IDS)
    event = flight.told[0]
    assert (event.level, event.kind, event.uav_id) in {
        (WARN, "energy", "uav1"),
        (ERROR, "energy", "uav1"),
    }
    assert "cannot pay for its least powers from slot" in event.text


@pytest.mark.parametrize(("extra_db", "ratio"), [(3.0, 2.0), (0.0, 1.0)])
def test_loss_that_radios_measure_raises_the_least_powers(extra_db, ratio) -> None:
    """Where links lose 3 dB more than planned, the powers double; where they do not, they stay."""
    flight = _Flight()
    flight.at(0.5)
    flight.measure(0.4, *IDS)
    before = flight.least_w()
    air = Air(
        [AirMember(uav, 30.0, 50.0) for uav in IDS],
        Radio(),
        AirSettings(path_loss_error_db=extra_db),
    )
    places = np.array([[0.0, 100.0 * index, 50.0] for index in range(3)])
    # Enough of them to outweigh the belief that all is as planned.
    for report in range(100):
        stamp_ns = START_NS + round((0.5 + 0.01 * report) * 1e9)
        measured = air.step(0.01, places, stamp_ns=stamp_ns)
        gain = AirArray(measured.stamp_ns, measured.uav_ids, measured.gain)
        flight.run.hand_over(flight.core.take_gain, gain)
    flight.at(2.1)
    flight.measure(2.05, *IDS)
    assert len(flight.solved) == 2
    assert flight.least_w() / before == pytest.approx(ratio, rel=0.1)


def test_a_clock_set_back_is_told_and_followed() -> None:
    """From 8.1 s to 4.1 s: earlier poses do not count, and slot 2 is solved with new ones."""
    flight = _Flight()
    flight.at(8.1)
    flight.measure(8.1, *IDS)
    assert flight.firsts() == [4]
    flight.run = CoreRun(flight.core, at(4.1), flight._take)
    flight.measure(4.1, *IDS)
    assert [event.text for event in flight.told] == [
        "The clock was set back by 4.0 s: earlier poses do not count."
    ]
    assert flight.firsts() == [4, 2]


def test_a_pose_from_the_future_is_refused() -> None:
    """More than a second ahead of the clock it would hide those that come after it."""
    flight = _Flight()
    with pytest.raises(MessageError, match=r"header\.stamp: is 1\.5 s ahead of this clock"):
        flight.core.take_pose("uav1", pose(1.5, 0.0, 0.0), at(0.0))


def test_stepping_more_often_changes_nothing() -> None:
    """A timer that fires twice solves no slot twice and tells nothing twice."""
    once, twice = _Flight(), _Flight()
    for flight in (once, twice):
        for tenth in range(1, 100):
            flight.at(0.1 * tenth)
            if tenth % 3 == 0:
                flight.measure(0.1 * tenth, *IDS[: 2 if tenth > 30 else 3])
            for _ in range(2 if flight is twice else 0):
                flight.run.step()
    assert twice.firsts() == once.firsts()
    assert [event.text for event in twice.told] == [event.text for event in once.told]
    for one, other in zip(once.solved, twice.solved, strict=True):
        assert np.array_equal(one.intervals.bounds_w, other.intervals.bounds_w)
