"""The recorded flights of this folder, read for tests and benchmarks."""

import csv
from pathlib import Path

import numpy as np

from jfto_world.motion.arducopter import WpNav, fly_route
from support.spline_flight import fly_splines

DATA = Path(__file__).parent

_CENTI = {
    "WPNAV_SPEED": "speed_mps",
    "WPNAV_SPEED_UP": "speed_up_mps",
    "WPNAV_SPEED_DN": "speed_dn_mps",
    "WPNAV_ACCEL": "accel_mps2",
    "WPNAV_ACCEL_Z": "accel_z_mps2",
    "WPNAV_ACCEL_C": "corner_accel_mps2",
    "WPNAV_RADIUS": "radius_m",
    "ANGLE_MAX": "angle_max_deg",
}


def rows(name):
    with (DATA / name).open() as file:
        return list(csv.DictReader(file))


def mission_route():
    points = rows("mission20_waypoints.csv")
    places = [[float(r[k]) for k in ("east_m", "north_m", "height_m")] for r in points]
    return np.array([[0.0, 0.0, 60.0], *places])


def wpnav_of(parameters):
    values = dict(p.split("=") for p in parameters.split())
    fields = {_CENTI[k]: float(v) / 100 for k, v in values.items() if k in _CENTI}
    if "WPNAV_JERK" in values:
        fields["jerk_mps3"] = float(values["WPNAV_JERK"])
    return WpNav(**fields)


def wind_of(parameters):
    """East and north components of where the air moves to; SIM_WIND_DIR is where it comes from."""
    values = dict(p.split("=") for p in parameters.split())
    speed = float(values.get("SIM_WIND_SPD", 0))
    angle = np.radians(float(values.get("SIM_WIND_DIR", 180)))
    return (-speed * np.sin(angle), -speed * np.cos(angle))


def runs():
    """Run name to (parameters, measured, planner, closed loop) with (20,) leg times."""
    found = {}
    for row in rows("mission20_leg_times.csv"):
        found.setdefault(row["run"], []).append(row)
    columns = ("measured_s", "planner_s", "closed_loop_s")
    return {
        name: (legs[0]["parameters"], *(np.array([float(r[c]) for r in legs]) for c in columns))
        for name, legs in found.items()
    }


def flown_leg_times(name):
    """Leg times (20,) of a recorded run in closed loop."""
    parameters = runs()[name][0]
    wpnav, wind = wpnav_of(parameters), wind_of(parameters)
    if name.startswith("c"):
        flight = fly_splines(mission_route(), wpnav, wind_mps=wind)
    else:
        hold = np.full(21, 1.0) if name.startswith("d") else None
        flight = fly_route(mission_route(), wpnav, hold_s=hold, wind_mps=wind)
    return np.diff(flight.reached_s)


def track(name):
    """Times (K,) and positions (K, 3) of a recorded truth track."""
    table = np.loadtxt(DATA / f"track_{name}.csv", delimiter=",", skiprows=1)
    return table[:, 0], table[:, 1:4]
