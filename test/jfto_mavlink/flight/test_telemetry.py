"""Times of measurements, and what diagnostics make of a link's state."""

from __future__ import annotations

import dataclasses
import math

import pytest

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.flight.telemetry import (
    BatterySample,
    LinkState,
    PositionSample,
    listen,
    measured_s,
)
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.protocol.exchange import Activity
from jfto_mavlink.ros_messages import Expected, uav_status
from jfto_msgs_py.ros.diagnostics import ERROR, OK, STALE, WARN

NS = 10**9
GOOD = LinkState(
    "uav1", 100.0, 0.4, "AUTO", True, True, False, 5.0, 0.02, 0.001, 0.01, 0, 2, 7, -1.5
)
# A quarter of a 3 s slot.
EXPECTED = Expected(0.75)


def compare_clocks(rig, offset_s: float, rtt_s: float = 0.04) -> None:
    """One TIMESYNC answer of a vehicle whose clock is ahead by an offset."""
    sent_ns = int(rig.now_s * NS)
    vehicle_ns = int((rig.now_s + rtt_s / 2 + offset_s) * NS)
    rig.now_s += rtt_s
    rig.vehicle.time_sync.answer(sent_ns, vehicle_ns, int(rig.now_s * NS))


def test_stamps_are_when_it_was_measured_not_when_it_came(rig):
    """The vehicle's boot clock, less the offset that TIMESYNC found."""
    rig.now_s = 50.0
    assert measured_s(rig.context, 812.0) == 50.0
    compare_clocks(rig, 760.0)
    rig.now_s = 52.0
    assert measured_s(rig.context, 760.0 + 51.7) == pytest.approx(51.7, abs=1e-6)


def test_a_stamp_is_never_in_the_future_nor_of_another_boot(rig):
    """Then it counts as measured when it came."""
    rig.now_s = 50.0
    compare_clocks(rig, 760.0)
    assert measured_s(rig.context, 760.0 + rig.now_s + 0.01) == rig.now_s
    assert measured_s(rig.context, 3.0) == rig.now_s


def test_what_a_vehicle_reports_becomes_records(rig, plan):
    """Positions above home, batteries with NaN for what is not known, none before a place is."""
    mission = build_missions(plan, MissionSettings())[0]
    found = []
    activity = Activity(
        listen(rig.context, mission, found.append), lambda _m: None, lambda _r: None
    )
    for message in (
        mavlink.MAVLink_global_position_int_message(1000, 0, 0, 0, 0, 0, 0, 0, 0),
        mavlink.MAVLink_global_position_int_message(
            1000, 473977420, 85455940, 500000, 12000, 0, 0, 0, 9000
        ),
        mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 12600, -1, -1, 0, 0, 0, 0, 0, 0),
    ):
        rig.vehicle.update(message, rig.now_s)
        activity.feed(message)
    (position,) = [sample for sample in found if isinstance(sample, PositionSample)]
    assert (position.lat_deg, position.height_m, position.yaw_deg) == (47.397742, 12.0, 90.0)
    (battery,) = [sample for sample in found if isinstance(sample, BatterySample)]
    assert battery.voltage_v == pytest.approx(12.6)
    assert math.isnan(battery.current_a)
    assert math.isnan(battery.share)
    assert any(isinstance(sample, LinkState) for sample in found)


@pytest.mark.parametrize(
    ("changes", "expected", "level", "words"),
    [
        ({}, EXPECTED, OK, "AUTO, armed, waypoint 7 -1.5 s"),
        ({"utc_error_s": -0.8}, EXPECTED, WARN, "0.800 s wrong, a quarter slot is 0.750 s"),
        ({"round_trip_s": 1.4, "jitter_s": 0.1}, EXPECTED, WARN, "0.800 s wrong"),
        ({"offset_s": None}, EXPECTED, WARN, "not compared"),
        ({"silent_s": 6.0}, EXPECTED, STALE, "silent for 7.0 s"),
        ({"silent_s": math.inf}, EXPECTED, STALE, "never heard"),
        ({"failsafe": True}, EXPECTED, ERROR, "failsafe"),
        ({}, Expected(0.75, "two vehicles answer"), ERROR, "two vehicles answer"),
    ],
)
def test_diagnostics_say_the_worst(changes, expected, level, words):
    """A time that may be wrong by more than a quarter slot is a warning."""
    status = uav_status("uav1", dataclasses.replace(GOOD, **changes), 101.0, expected)
    assert status.level == level
    assert words in status.text
    assert status.facts["late_s"] == "-1.5"
