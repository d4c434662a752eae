"""Small fleets with straight trajectories."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.vehicle import TimedTrajectory, VehiclePose
from jfto_world.motion.fleet_prediction import FleetPrediction

START_NS = 1_763_776_800 * 10**9
SPEED_MPS = 5.0
DURATION_S = 20.0


def eastward(north_m: float) -> TimedTrajectory:
    """Twenty seconds eastward at 5 m/s, `north_m` north of the origin."""
    offsets = np.array([0, round(DURATION_S * 1e9)])
    points = np.array([[0.0, north_m, 50.0], [SPEED_MPS * DURATION_S, north_m, 50.0]])
    return TimedTrajectory(START_NS, offsets, points, np.zeros((2, 3)), np.zeros((2, 3)))


def at(seconds: float) -> int:
    """Time in ns of an instant counted from the start."""
    return START_NS + round(seconds * 1e9)


def pose(seconds: float, east_m: float, north_m: float) -> VehiclePose:
    """A measured pose."""
    return VehiclePose(at(seconds), (east_m, north_m, 50.0), 90.0)


def column(count: int, spacing_m: float = 100.0) -> FleetPrediction:
    """UAVs side by side, flying east together."""
    prediction = FleetPrediction()
    for index in range(count):
        prediction.set_trajectory(f"uav{index + 1}", eastward(index * spacing_m))
    return prediction
