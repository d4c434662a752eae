"""Whole missions flown by the simulator next to the flights of a real ArduCopter."""

import csv
from pathlib import Path

import numpy as np
import pytest

from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.dialect import mavlink as m
from jfto_sim.geodesy import move
from jfto_sim.mission.items import Item
from jfto_sim.modes.mode import Mode
from support.pilot import Pilot

DATA = Path(__file__).parents[2] / "data" / "timing"
HOME = (466_000_000, 85_000_000)
MEAN_S, WORST_S, RMS_M = 0.2, 0.9, 1.5


def rows(name):
    with (DATA / name).open() as file:
        return list(csv.DictReader(file))


def fly(parameters, hold_s):
    """Leg times and track (time, east, north, up) of the 20-waypoint mission."""
    config = VehicleConfig(
        home_lat_deg=46.6, home_lon_deg=8.5, home_alt_m=488.0, parameters=parameters
    )
    vehicle = Vehicle(config)
    pilot = Pilot(vehicle)
    pilot.take_off(60.0)
    pilot.run(5.0)
    items = [Item(16, 0, (0, 0, 0, 0), *HOME, 488.0)]
    for row in rows("mission20_waypoints.csv"):
        lat, lon = move(*HOME, float(row["east_m"]), float(row["north_m"]))
        items.append(Item(16, 6, (hold_s, 0, 0, 0), lat, lon, float(row["height_m"])))
    assert pilot.upload(items) == m.MAV_MISSION_ACCEPTED
    pilot.send(m.MAVLink_set_mode_message(1, 1, Mode.AUTO))
    while vehicle.mode.number != Mode.AUTO:
        pilot.run(0.005)
    begin, track, reached = vehicle.time_s, [], []
    while len(reached) < 20 and vehicle.time_s - begin < 700:
        for heard in pilot.run(0.05):
            if heard.message.get_type() == "MISSION_ITEM_REACHED":
                reached.append(heard.time_s - begin - 0.025)
        track.append((vehicle.time_s - begin, *vehicle.body.position_m))
    return np.diff([0.0, *reached]), np.array(track)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("run", "parameters", "hold_s", "track"),
    [
        ("a1", {}, 0.0, "track_a_plain_run1.csv"),
        ("a_v8", {"WPNAV_SPEED": 800}, 0.0, "track_a_plain_v8.csv"),
        ("d", {}, 1.0, "track_d_hold1.csv"),
    ],
)
def test_mission_is_flown_like_the_real_one(run, parameters, hold_s, track):
    """Leg times within 0.2 s mean and 0.9 s at most, positions within 1.5 m RMS."""
    legs, flown = fly(parameters, hold_s)
    truth = [float(r["measured_s"]) for r in rows("mission20_leg_times.csv") if r["run"] == run]
    error = np.abs(legs - truth)
    table = np.array([[float(v) for v in row.values()] for row in rows(track)])
    table = table[table[:, 0] <= flown[-1, 0]]
    at = np.stack([np.interp(table[:, 0], flown[:, 0], flown[:, k]) for k in (1, 2, 3)], -1)
    rms = np.sqrt(np.mean(np.sum((at - table[:, 1:4]) ** 2, axis=-1)))
    print(f"{run}: mean {error.mean():.3f} s, worst {error.max():.2f} s, track {rms:.2f} m RMS")
    assert error.mean() <= MEAN_S
    assert error.max() <= WORST_S
    assert rms <= RMS_M
