"""MAVLink 2 signing, port by port."""

import hashlib

import pytest

from jfto_sim import Vehicle
from jfto_sim.dialect import mavlink as m
from jfto_sim.signing import EPOCH_2015_US
from support.pilot import Pilot

KEY = hashlib.sha256(b"test key one").digest()
WRONG = hashlib.sha256(b"wrong key").digest()
HOUR = 360_000_000


def now(vehicle):
    return (vehicle.utc_us - EPOCH_2015_US) // 10


def request(vehicle, key=None, stamp=0, link=0, mavlink1=False):
    codec = m.MAVLink(None, 255, 190)
    if key is not None:
        codec.signing.sign_outgoing, codec.signing.secret_key = True, key
        codec.signing.timestamp, codec.signing.link_id = stamp, link
    message = m.MAVLink_command_long_message(1, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0)
    return bytes(message.pack(codec, force_mavlink1=mavlink1))


def answered(vehicle, frame, port):
    vehicle.handle(frame, port)
    frames = [f for p, f in vehicle.advance(0.02) if p == port]
    codec = m.MAVLink(None)
    kinds = [codec.decode(bytearray(f)).get_type() for f in frames]
    return "COMMAND_ACK" in kinds


@pytest.fixture
def vehicle():
    vehicle = Vehicle()
    pilot = Pilot(vehicle)
    pilot.run(5.0)
    pilot.send(m.MAVLink_setup_signing_message(1, 1, list(KEY), now(vehicle)))
    pilot.run(0.1)
    return vehicle


def test_every_frame_is_signed_on_every_port(vehicle):
    """From the set-up on all ports sign, with the port's number as link id."""
    frames = vehicle.advance(2.0)
    assert {p for p, _ in frames} == {0, 1, 2}
    for port, frame in frames:
        assert frame[2] & 1
        assert frame[-13] == port
        digest = hashlib.sha256(KEY + frame[:-6]).digest()
        assert digest[:6] == frame[-6:]


def test_the_first_port_takes_everything(vehicle):
    """Unsigned, wrongly signed and old frames are taken on port 0."""
    assert answered(vehicle, request(vehicle), 0)
    assert answered(vehicle, request(vehicle, WRONG, now(vehicle)), 0)
    assert answered(vehicle, request(vehicle, KEY, now(vehicle) - HOUR), 0)


def test_other_ports_take_only_well_signed_frames(vehicle):
    """Unsigned, wrong key, MAVLink 1 and an hour old are dropped without a word."""
    assert not answered(vehicle, request(vehicle), 1)
    assert not answered(vehicle, request(vehicle, WRONG, now(vehicle)), 1)
    assert not answered(vehicle, request(vehicle, mavlink1=True), 1)
    assert not answered(vehicle, request(vehicle, KEY, now(vehicle) - HOUR), 1)
    assert not answered(vehicle, request(vehicle, KEY, now(vehicle) - HOUR, link=5), 1)
    assert answered(vehicle, request(vehicle, KEY, now(vehicle)), 1)
    assert vehicle.ports[1].refused == 5


def test_replay_is_dropped(vehicle):
    """The exact frame a second time is not answered."""
    frame = request(vehicle, KEY, now(vehicle))
    assert answered(vehicle, frame, 1)
    assert not answered(vehicle, frame, 1)


def test_time_stamps_ahead_are_fine(vehicle):
    """Five seconds ahead is accepted, and the vehicle's own stamps stay ahead of it."""
    ahead = now(vehicle) + 500_000
    assert answered(vehicle, request(vehicle, KEY, ahead), 1)
    (_, frame), *_ = vehicle.advance(2.0)
    assert int.from_bytes(frame[-12:-6], "little") >= ahead


def test_the_key_survives_a_restart_and_zeros_switch_off(vehicle):
    """After a restart port 1 still demands the key; 32 zero bytes end signing."""
    vehicle.reboot()
    vehicle.advance(3.0)
    assert not answered(vehicle, request(vehicle), 1)
    pilot = Pilot(vehicle)
    pilot.send(m.MAVLink_setup_signing_message(1, 1, [0] * 32, 0))
    pilot.run(0.1)
    assert answered(vehicle, request(vehicle), 1)


def test_no_new_key_while_armed(vehicle):
    """SETUP_SIGNING is refused in words when armed."""
    pilot = Pilot(vehicle)
    pilot.take_off(5.0)
    pilot.send(m.MAVLink_setup_signing_message(1, 1, list(WRONG), 0))
    pilot.run(0.1)
    assert "ERROR: Won't setup signing when armed" in pilot.texts()
    assert vehicle.key.secret == KEY
