"""A vehicle's state from recorded messages of the real autopilot."""

from __future__ import annotations

import pytest

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.protocol.vehicle_state import VehicleState


def test_a_recorded_power_up_is_understood(recording):
    """Mode, texts, home and identity from recording 01, seconds as recorded."""
    vehicle = VehicleState("uav1")
    for at_s, message in recording("01_connect_params.tlog"):
        if message.get_srcSystem() == 1:
            vehicle.update(message, at_s)
    assert vehicle.mode_name == "STABILIZE"
    assert not vehicle.armed
    assert vehicle.home_deg_m == pytest.approx((47.397742, 8.545594, 488.1))
    assert bytes.fromhex(vehicle.uid).startswith(b"3d1219c7c4c5404a")
    assert any("using GPS" in text.text for text in vehicle.texts)


def test_long_texts_are_put_together():
    """Pieces of 50 characters under one id; a short piece ends the text."""
    vehicle = VehicleState("uav1")
    words = "PreArm: " + "x" * 60
    for n, piece in enumerate((words[:50], words[50:])):
        message = mavlink.MAVLink_statustext_message(4, piece.encode(), 7, n)
        vehicle.update(message, 1.0)
    assert [text.text for text in vehicle.texts] == [words]


def test_texts_are_filtered_by_time_and_severity_and_told_once():
    """Only what is bad and new."""
    vehicle = VehicleState("uav1")
    for at_s, severity, text in ((1, 4, "old"), (2, 6, "info"), (3, 2, "bad"), (4, 2, "bad")):
        vehicle.update(mavlink.MAVLink_statustext_message(severity, text.encode()), at_s)
    assert vehicle.texts_since(2.0) == ["bad"]


def test_unknown_battery_values_stay_unknown():
    """65535 mV and -1 % mean "not measured"."""
    vehicle = VehicleState("uav1")
    vehicle.update(
        mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 0xFFFF, -1, -1, 0, 0, 0, 0, 0, 0), 1.0
    )
    assert vehicle.battery_v is None
    assert vehicle.battery_percent is None


def test_old_datagrams_are_no_reboot_and_a_reboot_forgets_what_is_untrue():
    """Half a second back is reordering, a minute back is a restart."""
    vehicle = VehicleState("uav1")

    def position(boot_ms: int) -> None:
        vehicle.update(
            mavlink.MAVLink_global_position_int_message(boot_ms, 1, 1, 0, 0, 0, 0, 0, 0), 1.0
        )

    position(60_000)
    vehicle.home_deg_m = (1.0, 2.0, 3.0)
    position(59_500)
    assert vehicle.reboots == 0
    position(900)
    assert vehicle.reboots == 1
    assert vehicle.home_deg_m is None
