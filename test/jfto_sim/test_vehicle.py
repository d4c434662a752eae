"""The vehicle as a state machine: determinism, boot, clocks, restart, power off, garbage."""

import tracemalloc

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.dialect import mavlink as m
from jfto_sim.mission.items import NAMES, Item
from support.pilot import Pilot


def script(vehicle):
    pilot = Pilot(vehicle)
    pilot.take_off(5.0)
    pilot.every(m.MAVLINK_MSG_ID_GLOBAL_POSITION_INT, 0.1)
    pilot.run(2.0)
    return [bytes(h.message.get_msgbuf()) for h in pilot.heard]


def test_same_inputs_give_the_same_bytes():
    """Two vehicles with one seed and one script send identical frames, noise included."""
    config = VehicleConfig(gps_noise_m=1.0, seed=7)
    assert script(Vehicle(config)) == script(Vehicle(config))


def test_seed_changes_the_noise():
    """Another seed, other noise."""
    frames = [script(Vehicle(VehicleConfig(gps_noise_m=1.0, seed=s))) for s in (1, 2)]
    assert frames[0] != frames[1]


def test_steps_of_any_length_lead_to_the_same_flight():
    """How `advance` is cut into pieces does not change what happens."""
    texts = []
    for step in (0.003, 0.05, 1.7):
        vehicle = Vehicle()
        vehicle.handle(
            bytes(m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3).pack(m.MAVLink(None, 255, 190)))
        )
        frames = []
        while vehicle.time_s < 43.0 - 1e-9:
            frames += vehicle.advance(min(step, 43.0 - vehicle.time_s))
        texts.append(frames)
    assert texts[0] == texts[1] == texts[2]


def test_silent_port_hears_only_heartbeat_timesync_and_home():
    """Texts and parameters go only to a port on which something was heard."""
    codec = m.MAVLink(None)
    kinds = {codec.decode(bytearray(f)).get_type() for _, f in Vehicle().advance(45.0)}
    assert kinds == {"HEARTBEAT", "TIMESYNC", "HOME_POSITION", "GPS_GLOBAL_ORIGIN"}


def test_boot_takes_its_time():
    """Arming is refused with the recorded reasons until the EKF uses the GPS at 41 s."""
    pilot = Pilot(Vehicle())
    pilot.run(2.5)
    assert pilot.command(400, 1) == m.MAV_RESULT_FAILED
    pilot.run(0.1)
    assert [text for text in pilot.texts() if text.startswith("Arm")] == [
        "Arm: Accels inconsistent",
        "Arm: EKF attitude is bad",
        "Arm: AHRS: not using configured AHRS type",
    ]
    pilot.run(30.0 - pilot.vehicle.time_s)
    assert "Arming motors" not in pilot.texts()
    assert pilot.command(176, 1, 4) == m.MAV_RESULT_ACCEPTED
    assert pilot.command(400, 1) == m.MAV_RESULT_FAILED
    pilot.ready()
    assert pilot.command(400, 1) == m.MAV_RESULT_ACCEPTED


def test_mode_shows_in_an_immediate_heartbeat():
    """A changed mode is announced at once, not at the next second."""
    pilot = Pilot(Vehicle())
    pilot.run(3.1)
    pilot.command(176, 1, 4)
    modes = [
        h for h in pilot.heard if h.message.get_type() == "HEARTBEAT" and h.message.custom_mode == 4
    ]
    assert modes[0].time_s - 3.1 < 0.1


def test_reboot_keeps_storage_and_forgets_streams():
    """Missions and parameters survive, message intervals do not; the clock starts again."""
    pilot = Pilot(Vehicle())
    pilot.run(21.0)
    pilot.upload([Item(16, 6, x=1, y=1, z_m=5.0)] * 4)
    pilot.set_parameter("WPNAV_SPEED", 500)
    pilot.every(m.MAVLINK_MSG_ID_ATTITUDE, 0.1)
    assert pilot.command(246, 1) == m.MAV_RESULT_ACCEPTED
    pilot.run(3.0)
    assert pilot.vehicle.time_s < 3.0
    assert pilot.vehicle.store.count(0) == 4
    assert pilot.vehicle.params["WPNAV_SPEED"] == 500
    assert not [h for h in pilot.run(2.0) if h.message.get_type() == "ATTITUDE"]


def test_reboot_is_refused_in_flight():
    """FAILED when armed."""
    pilot = Pilot(Vehicle())
    pilot.take_off(5.0)
    assert pilot.command(246, 1) == m.MAV_RESULT_FAILED


def test_killed_vehicle_is_silent():
    """After power off nothing is sent and nothing is taken."""
    vehicle = Vehicle()
    vehicle.advance(5.0)
    vehicle.kill()
    vehicle.handle(b"\xfd")
    assert vehicle.advance(10.0) == []


def test_clock_drift_shows_in_the_time_stamps():
    """A clock 1000 ppm fast gains 0.1 s in 100 s."""
    vehicle = Vehicle(VehicleConfig(clock_drift_ppm=1000.0))
    vehicle.advance(100.0)
    assert vehicle.time_s == pytest.approx(100.1, abs=1e-6)


def test_timesync_is_answered_with_the_vehicles_clock():
    """tc1 is the vehicle's clock, ts1 is echoed."""
    pilot = Pilot(Vehicle())
    pilot.run(3.0)
    pilot.send(m.MAVLink_timesync_message(0, 123456789))
    answer = pilot.wait(lambda x: x.get_type() == "TIMESYNC" and x.ts1 == 123456789).message
    assert answer.tc1 == pytest.approx(pilot.vehicle.time_s * 1e9, abs=6e7)


def test_two_vehicles_have_different_uids():
    """AUTOPILOT_VERSION tells vehicles apart."""
    assert VehicleConfig(sysid=1).identity != VehicleConfig(sysid=2).identity
    assert len(VehicleConfig(sysid=255).identity) == 18


@pytest.mark.parametrize("bad", [{"sysid": 0}, {"home_lat_deg": 91}, {"port_count": 0},
                                 {"uid2": (1, 2)}, {"gps_noise_m": -1}])  # fmt: skip
def test_impossible_configurations_are_refused(bad):
    """Each wrong value is named."""
    with pytest.raises(InputError):
        VehicleConfig(**bad)


def malformed(rng, count):
    codec = m.MAVLink(None, 255, 190)
    good = [
        m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3),
        m.MAVLink_command_long_message(1, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0),
        m.MAVLink_mission_count_message(1, 1, 5, 0),
        m.MAVLink_mission_item_int_message(1, 1, 0, 6, 16, 0, 1, 0, 0, 0, 0, 1, 2, 3.0, 0),
        m.MAVLink_param_set_message(1, 1, b"WPNAV_SPEED", 5.0, 9),
        m.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, 0, *[1.0] * 11),
    ]
    for k in range(count):
        frame = bytearray(good[k % len(good)].pack(codec))
        what = rng.integers(4)
        if what == 0:
            frame[rng.integers(len(frame))] ^= int(rng.integers(1, 256))
        elif what == 1:
            frame = frame[: rng.integers(len(frame))]
        elif what == 2:
            frame = bytearray(rng.bytes(int(rng.integers(1, 300))))
        else:
            frame += rng.bytes(5)
        yield bytes(frame)


@pytest.mark.slow
def test_ten_thousand_malformed_frames_do_no_harm():
    """Broken frames and random bytes neither stop the vehicle nor make it grow."""
    vehicle = Vehicle()
    vehicle.advance(45.0)
    rng = np.random.default_rng(1)
    sizes = []
    tracemalloc.start()
    for frame in malformed(rng, 10_000):
        vehicle.handle(frame)
        if len(sizes) % 10 == 0:
            vehicle.advance(0.01)
        sizes.append(0 if len(sizes) not in (4000, 9999) else tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    assert max(sizes[5000:]) - sizes[4000] < 500_000
    vehicle.handle(bytes(300))
    vehicle.advance(1.0)
    pilot = Pilot(vehicle)
    assert pilot.command(512, 148) == m.MAV_RESULT_ACCEPTED


@pytest.mark.slow
def test_valid_frames_with_wild_values_do_no_harm():
    """Well-formed messages of every kind it handles, with NaN, infinity and extremes."""
    vehicle = Vehicle()
    pilot = Pilot(vehicle)
    pilot.take_off(5.0)
    rng = np.random.default_rng(2)
    wild = [float("nan"), float("inf"), -1e30, 1e30, 0.0, -1.0, 3.0, 4.0, 255.0, 5000.0]

    def pick():
        return float(rng.choice(wild))

    def whole():
        return int(rng.integers(-(2**31), 2**31))

    for _ in range(1500):
        frame, mask = int(rng.integers(0, 12)), int(rng.integers(0, 4096))
        command = int(rng.choice([16, 20, 21, 22, 115, 176, 178, 179, 192, 193, 195, 201, 203, 206,
                                  224, 300, 400, 401, 510, 511, 512, 520, 2000]))  # fmt: skip
        values = [pick() for _ in range(9)]
        pilot.send(m.MAVLink_command_long_message(1, 1, command, 0, *values[:7]))
        pilot.send(m.MAVLink_command_int_message(1, 1, frame, command, 0, 0, *values[:4], whole(),
                                                 whole(), values[4]))  # fmt: skip
        pilot.send(m.MAVLink_set_position_target_local_ned_message(0, 1, 1, frame, mask, *values,
                                                                   pick(), pick()))  # fmt: skip
        pilot.send(m.MAVLink_set_position_target_global_int_message(
            0, 1, 1, frame, mask, whole(), whole(), *values[:7], pick(), pick()))  # fmt: skip
        pilot.run(0.05)
    assert np.isfinite(vehicle.body.state).all()


def test_wild_missions_are_flown_or_refused():
    """Random items with random parameters: AUTO neither breaks nor loses its state."""
    rng = np.random.default_rng(3)
    commands = [*NAMES, 5001, 5003, 5100, 31000]
    wild = [0.0, -1.0, 1.0, 2.0, 3.0, 90.0, 1e30, -1e30, 255.0, 70000.0, 0.5]
    pilot = Pilot(Vehicle(VehicleConfig(parameters={"CAM1_TYPE": 1, "MNT1_TYPE": 1})))
    pilot.take_off(10.0)
    vehicle = pilot.vehicle
    lat, lon = vehicle.flight.position.origin
    for _ in range(40):
        items = []
        for _ in range(6):
            near = rng.random() < 0.8
            spread = 5000 if near else 2**30
            items.append(
                Item(
                    int(rng.choice(commands)), int(rng.choice([0, 3, 6, 10])),
                    tuple(float(rng.choice(wild)) for _ in range(4)),
                    lat + int(rng.integers(-spread, spread)) if near else 0,
                    lon + int(rng.integers(-spread, spread)),
                    float(rng.choice([0.0, 5.0, 20.0, -30.0])),
                )
            )  # fmt: skip
        for kind in (0, 1, 2):
            pilot.upload(items, kind)
        pilot.command(300)
        pilot.run(8.0)
        pilot.command(176, 1, 4)
        assert np.isfinite(vehicle.body.state).all()
    pilot.every(m.MAVLINK_MSG_ID_GLOBAL_POSITION_INT, 0.1)
    assert pilot.wait_type("GLOBAL_POSITION_INT")


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1.0, 2.0, 1e30])
def test_wild_fences_are_refused(value):
    """A polygon with an impossible number of corners, and a float item without a place."""
    pilot = Pilot(Vehicle())
    pilot.run(5.0)
    assert pilot.upload([Item(5001, 0, (value, 0, 0, 0), 1, 1)], 1) == m.MAV_MISSION_ERROR
    pilot.send(m.MAVLink_mission_count_message(1, 1, 1, 2))
    pilot.wait_type("MISSION_REQUEST")
    nan = float("nan")
    pilot.send(m.MAVLink_mission_item_message(1, 1, 0, 3, 5100, 0, 1, 0, 0, 0, 0, nan, nan, nan, 2))
    assert pilot.wait_type("MISSION_ACK").message.type == m.MAV_MISSION_INVALID_PARAM5_X
