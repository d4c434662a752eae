"""Commands and parameters as conversations, against a scripted vehicle."""

from __future__ import annotations

import pytest

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import CommandError
from jfto_mavlink.protocol.command import send_command, set_mode
from jfto_mavlink.protocol.parameter import read_parameter, set_parameter

ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM


def ack(command: int, result: int, system: int = 255, component: int = 191):
    return mavlink.MAVLink_command_ack_message(command, result, 0, 0, system, component)


def heartbeat(mode: int):
    return mavlink.MAVLink_heartbeat_message(2, 3, 81, mode, 4, 3)


def value(number: float, name: bytes = b"WPNAV_SPEED"):
    return mavlink.MAVLink_param_value_message(name, number, 9, 1364, 65535)


def test_a_lost_command_is_sent_again_and_counts_its_copies(rig):
    """The confirmation field tells a vehicle that it is a copy."""
    answers = iter([[], [], [(0.01, ack(ARM, 0))]])
    rig.run(send_command(rig.context, ARM, (1.0,)), lambda m, t: next(answers))
    assert [m.confirmation for _, m in rig.sent] == [0, 1, 2]
    assert rig.now_s < 5.0


def test_a_refusal_is_final_and_quotes_the_vehicle(rig):
    """Texts follow the acknowledgement; both reasons come through, once each."""

    def refuse(message, now_s):
        reasons = (b"Arm: Battery 1 below minimum", b"Arm: Compass not healthy")
        texts = [mavlink.MAVLink_statustext_message(2, r) for r in (*reasons, reasons[0])]
        return [(0.005, ack(ARM, 4)), *((0.01, text) for text in texts)]

    with pytest.raises(CommandError) as caught:
        rig.run(send_command(rig.context, ARM, (1.0,)), refuse)
    assert caught.value.code == 503
    assert caught.value.reasons == ("Arm: Battery 1 below minimum", "Arm: Compass not healthy")
    assert len(rig.sent) == 1


@pytest.mark.parametrize(("result", "code"), [(2, 502), (3, 504), (4, 503)])
def test_each_refusal_has_its_number(rig, result, code):
    """Denied, unsupported, failed."""
    with pytest.raises(CommandError) as caught:
        rig.run(send_command(rig.context, ARM), lambda m, t: [(0.01, ack(ARM, result))])
    assert caught.value.code == code


def test_silence_ends_in_an_error_that_says_how_long(rig):
    """Twelve tries, then 501."""
    with pytest.raises(CommandError, match="12 tries") as caught:
        rig.run(send_command(rig.context, ARM), lambda m, t: [])
    assert caught.value.code == 501
    assert rig.now_s < 30.0


def test_a_busy_vehicle_is_asked_again(rig):
    """TEMPORARILY_REJECTED is not final, IN_PROGRESS prolongs the wait."""
    answers = iter([[(0.01, ack(ARM, 1))], [(0.01, ack(ARM, 5)), (4.0, ack(ARM, 0))]])
    rig.run(send_command(rig.context, ARM), lambda m, t: next(answers))
    assert len(rig.sent) == 2


def test_answers_to_other_stations_and_commands_are_not_ours(rig):
    """Someone else's acceptance is no acceptance of ours."""

    def crowd(message, now_s):
        return [
            (0.01, ack(ARM, 0, system=254)),
            (0.01, ack(ARM, 0, component=190)),
            (0.01, ack(176, 0)),
            (0.02, ack(ARM, 2)),
        ]

    with pytest.raises(CommandError):
        rig.run(send_command(rig.context, ARM), crowd)


def test_a_mode_change_must_be_seen(rig):
    """Accepted, but the heartbeat keeps the old mode: asked three times, then 505."""
    rig.vehicle.mode = 0
    with pytest.raises(CommandError, match="not in mode GUIDED") as caught:
        rig.run(set_mode(rig.context, 4), lambda m, t: [(0.01, ack(176, 0))])
    assert caught.value.code == 505
    assert len(rig.sent) == 3


def test_a_mode_change_seen_needs_no_acknowledgement(rig):
    """The lost answer does not matter when the heartbeat shows the mode."""
    rig.vehicle.mode = 0
    rig.run(set_mode(rig.context, 4), lambda m, t: [(0.02, heartbeat(4))])
    assert len(rig.sent) == 1


def test_a_parameter_is_set_when_its_new_value_comes_back(rig):
    """An old value still under way is not taken for the answer."""
    replies = [(0.01, value(500.0)), (0.02, value(1.0, b"OTHER")), (0.05, value(620.0))]
    rig.run(set_parameter(rig.context, "WPNAV_SPEED", 620.0), lambda m, t: replies)
    assert len(rig.sent) == 1


def test_a_read_only_parameter_is_named_with_its_value(rig):
    """Answered with the old value for good."""
    with pytest.raises(CommandError, match="WPNAV_SPEED is 500, not 620") as caught:
        rig.run(
            set_parameter(rig.context, "WPNAV_SPEED", 620.0), lambda m, t: [(0.01, value(500.0))]
        )
    assert caught.value.code == 507


def test_an_infinite_value_is_never_sent(rig):
    """ArduPilot stores what it gets."""
    with pytest.raises(CommandError):
        rig.run(set_parameter(rig.context, "WPNAV_SPEED", float("inf")), lambda m, t: [])
    assert rig.sent == []


def test_a_parameter_is_read_over_a_lossy_link(rig):
    """Asked again until it answers."""
    answers = iter([[], [], [(0.1, value(777.0))]])
    got = rig.run(read_parameter(rig.context, "WPNAV_SPEED"), lambda m, t: next(answers))
    assert got == 777.0
