"""GUIDED: streamed targets are followed as the real autopilot followed them."""

import lzma
from pathlib import Path

import numpy as np
import pytest

from jfto_sim import Vehicle
from jfto_sim.dialect import mavlink as m
from support.pilot import Pilot

DATA = Path(__file__).parents[2] / "data" / "ardupilot"
MASKS = {"P": 0xDF8, "PVA": 0xC00}
PARTS = ("ref_n", "ref_e", "ref_u", "ref_vn", "ref_ve", "ref_vu", "ref_an", "ref_ae", "ref_au")


def send(pilot, mask, values, yaw=0.0, yaw_rate=0.0):
    n, e, u, vn, ve, vu, an, ae, au = values
    pilot.send(
        m.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, 1, mask, n, e, -u, vn, ve, -vu, an, ae, -au, yaw, yaw_rate
        )
    )


@pytest.mark.slow
@pytest.mark.parametrize("fields", ["P", "PVA"])
def test_streamed_targets_are_followed_as_recorded(fields):
    """Position only lags by metres, all three fields track within half a metre, as measured."""
    text = lzma.decompress((DATA / f"guided_{fields}_10hz.csv.xz").read_bytes()).decode()
    table = np.genfromtxt(text.splitlines(), delimiter=",", names=True)
    pilot = Pilot(Vehicle())
    pilot.take_off(float(table["ref_u"][0]))
    begin, flown = pilot.vehicle.time_s, []
    for now in table["t_s"]:
        while pilot.vehicle.time_s - begin < now - 1e-6:
            at = pilot.vehicle.time_s - begin
            values = [float(np.interp(at, table["t_s"], table[name])) for name in PARTS]
            send(pilot, MASKS[fields], values)
            pilot.run(0.1)
        east, north, _ = pilot.vehicle.body.position_m
        flown.append((north, east))
    truth = np.stack([table["true_n"], table["true_e"]], -1)
    apart = np.sqrt(np.mean(np.sum((np.array(flown) - truth) ** 2, axis=-1)))
    assert apart < 0.5


@pytest.fixture
def pilot():
    pilot = Pilot(Vehicle())
    pilot.take_off(10.0)
    return pilot


def test_a_moving_target_stops_after_the_timeout(pilot):
    """3 s after the last velocity the vehicle comes to rest, without a text."""
    said = len(pilot.texts())
    for _ in range(30):
        send(pilot, 0xDC7, (0, 0, 0, 5, 0, 0, 0, 0, 0))
        pilot.run(0.1)
    pilot.run(2.5)
    assert pilot.vehicle.body.velocity_mps[1] == pytest.approx(5.0, abs=0.3)
    pilot.run(6.0)
    assert abs(pilot.vehicle.body.velocity_mps[1]) < 0.2
    assert len(pilot.texts()) == said


def test_global_targets_drop_the_acceleration(pilot):
    """With a position, the acceleration of the global form counts for nothing."""
    pilot.send(
        m.MAVLink_set_position_target_global_int_message(
            0, 1, 1, 6, 0xC00, *pilot.vehicle.flight.position.origin, 10.0, 0, 0, 0, 9, 9, 9, 0, 0
        )
    )
    pilot.run(0.1)
    assert pilot.vehicle.guided.accel == [0.0, 0.0, 0.0]


def test_waypoint_option_freezes_under_a_stream(pilot):
    """GUID_OPTIONS 64 restarts the planner with every target: streamed, it hardly moves."""
    pilot.set_parameter("GUID_OPTIONS", 64)
    for _ in range(50):
        send(pilot, 0xDF8, (60, 0, 10, 0, 0, 0, 0, 0, 0))
        pilot.run(0.1)
    assert pilot.vehicle.body.position_m[1] < 5.0
    pilot.run(15.0)
    assert pilot.vehicle.body.position_m[1] == pytest.approx(60.0, abs=1.0)


def test_reposition_and_yaw(pilot):
    """DO_REPOSITION flies there; a streamed heading is reached in about two seconds."""
    pilot.send(
        m.MAVLink_command_int_message(
            1, 1, 6, 192, 0, 0, -1, 1, 0, 0, pilot.vehicle.flight.position.origin[0] + 2000,
            pilot.vehicle.flight.position.origin[1], 15.0,
        )
    )  # fmt: skip
    pilot.run(20.0)
    assert pilot.vehicle.body.position_m[1:] == pytest.approx((22.26, 15.0), abs=0.3)
    for _ in range(25):
        send(pilot, 0x9F8, (22.26, 0, 15, 0, 0, 0, 0, 0, 0), yaw=np.pi / 2)
        pilot.run(0.1)
    assert pilot.vehicle.body.yaw_deg == pytest.approx(90.0, abs=10.0)


def test_takeoff_only_from_the_ground(pilot):
    """A second NAV_TAKEOFF in the air is FAILED."""
    assert pilot.command(22, 0, 0, 0, 0, 0, 0, 20) == m.MAV_RESULT_FAILED


def test_targets_are_ignored_in_other_modes(pilot):
    """A target in AUTO or BRAKE changes nothing."""
    pilot.command(176, 1, 17)
    send(pilot, 0xDF8, (50, 0, 10, 0, 0, 0, 0, 0, 0))
    pilot.run(5.0)
    assert abs(pilot.vehicle.body.position_m[1]) < 1.0
