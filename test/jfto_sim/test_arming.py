"""Arming rules and the words for each refusal."""

import pytest

from jfto_sim import Vehicle
from jfto_sim.dialect import mavlink as m
from jfto_sim.mission.items import Item
from support.pilot import Pilot

ACCEPTED, FAILED = m.MAV_RESULT_ACCEPTED, m.MAV_RESULT_FAILED


@pytest.fixture
def pilot():
    pilot = Pilot(Vehicle())
    pilot.ready()
    pilot.command(176, 1, 4)
    return pilot


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        (
            {"SIM_BATT_VOLTAGE": 9.0, "BATT_ARM_VOLT": 10.5},
            "Battery 1 below minimum arming voltage",
        ),
        ({"SIM_MAG1_FAIL": 1}, "Compass not healthy"),
        ({"ARMING_MIS_ITEMS": 8}, "Missing mission item: takeoff"),
        ({"SIM_GPS_DISABLE": 1}, "GPS 1: Bad fix"),
    ],
)
def test_refusals(pilot, parameters, text):
    """Within 2 s the reason is said unasked, and again as the answer to arming."""
    pilot.run(31.0)
    for name, value in parameters.items():
        pilot.set_parameter(name, value)
    pilot.run(2.0)
    assert f"PreArm: {text}" in pilot.texts()
    assert pilot.command(400, 1) == FAILED
    pilot.run(0.1)
    assert f"Arm: {text}" in pilot.texts()
    for name in parameters:
        pilot.set_parameter(name, 12.6 if name == "SIM_BATT_VOLTAGE" else 0)
    pilot.run(0.2)
    assert pilot.command(400, 1) == ACCEPTED


@pytest.mark.parametrize("mode", [6, 9, 17])
def test_modes_that_do_not_arm(pilot, mode):
    """RTL, LAND and BRAKE cannot be armed in."""
    pilot.command(176, 1, mode)
    assert pilot.command(400, 1) == FAILED
    pilot.run(0.1)
    assert pilot.texts()[-1].endswith("mode not armable")


def test_stabilize_arms_without_gps(pilot):
    """Without GPS GUIDED is refused, STABILIZE is not."""
    pilot.set_parameter("SIM_GPS_DISABLE", 1)
    pilot.run(0.5)
    assert pilot.command(400, 1) == FAILED
    pilot.command(176, 1, 0)
    assert pilot.command(400, 1) == ACCEPTED


def test_terrain_items_without_data(pilot):
    """A mission that counts from the terrain cannot be armed."""
    pilot.upload([Item(16, 0), Item(16, 11, x=473977420, y=85455940, z_m=30.0)])
    assert pilot.command(400, 1) == FAILED
    pilot.run(0.1)
    assert "Arm: waiting for terrain data" in pilot.texts()


def test_arming_again_and_disarming_again(pilot):
    """Both are ACCEPTED; home moves at the first."""
    homes = sum(h.message.get_type() == "HOME_POSITION" for h in pilot.heard)
    assert pilot.command(400, 1) == ACCEPTED
    pilot.run(0.1)
    assert sum(h.message.get_type() == "HOME_POSITION" for h in pilot.heard) == homes + 1
    assert [pilot.command(400, 1), pilot.command(400, 0), pilot.command(400, 0)] == [ACCEPTED] * 3


@pytest.mark.parametrize(("params", "result"), [
    ((1, 77), FAILED), ((0, 4), m.MAV_RESULT_DENIED), ((1, 5), ACCEPTED)])  # fmt: skip
def test_mode_changes(pilot, params, result):
    """An unknown mode FAILED with a text, without the custom bit DENIED."""
    assert pilot.command(176, *params) == result
    pilot.run(0.1)
    assert ("No such mode 77" in pilot.texts()) == (params[1] == 77)


def test_set_mode_message_is_answered_as_command_11(pilot):
    """SET_MODE gets COMMAND_ACK for command 11."""
    pilot.send(m.MAVLink_set_mode_message(1, 1, 0))
    ack = pilot.wait_type("COMMAND_ACK").message
    assert (ack.command, ack.result) == (11, ACCEPTED)
    assert pilot.vehicle.mode.number == 0


def test_takeoff_needs_arming(pilot):
    """NAV_TAKEOFF disarmed is FAILED."""
    assert pilot.command(22, 0, 0, 0, 0, 0, 0, 10) == FAILED


def test_failing_checks_are_said_every_half_minute(pilot):
    """A check that goes on failing is repeated about every 30 s."""
    pilot.set_parameter("SIM_MAG1_FAIL", 1)
    pilot.run(100.0)
    said = [h.time_s for h in pilot.heard
            if getattr(h.message, "text", "") == "PreArm: Compass not healthy"]  # fmt: skip
    assert 3 <= len(said) <= 4
    assert said[-1] - said[-2] == pytest.approx(31.0, abs=0.2)
