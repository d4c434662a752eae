"""Rules of the closed loop of planner and vehicle."""

import numpy as np
import pytest

from data.timing import flights
from jfto_msgs_py.errors import InfeasibleError
from jfto_world.motion.arducopter import WpNav, fly_route

RUNS = flights.runs()


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNS)
def test_leg_times_agree_with_the_flights(name):
    """Each leg within 0.9 s, 0.2 s on average, each mission within 1 % of the recorded flight."""
    predicted, measured = flights.flown_leg_times(name), RUNS[name][1]
    assert np.abs(predicted - measured).mean() <= 0.2
    assert np.abs(predicted - measured).max() <= 0.9
    assert predicted.sum() == pytest.approx(measured.sum(), rel=0.01)


@pytest.mark.parametrize(
    ("name", "hold_s", "speed_mps", "rms_m"),
    [("a_plain_run1", 0, 10, 2.0), ("a_plain_v8", 0, 8, 1.5), ("d_hold1", 1, 10, 2.5)],
)
def test_track_agrees_with_the_flight(name, hold_s, speed_mps, rms_m):
    """The vehicle is where the recorded one was, at each second of the mission."""
    hold = np.full(21, float(hold_s)) if hold_s else None
    flight = fly_route(flights.mission_route(), WpNav(speed_mps=speed_mps), hold_s=hold)
    times, truth = flights.track(name)
    inside = times <= flight.reached_s[-1]
    away = np.linalg.norm(flight.positions(times[inside]) - truth[inside], axis=1)
    assert np.sqrt(np.mean(away**2)) <= rms_m


def test_a_vehicle_leans_into_the_wind_before_it_starts():
    """The mission begins from a hover: wind does not push it off its first point."""
    route = np.array([[0.0, 0, 50], [200, 0, 50]])
    flight = fly_route(route, WpNav(), wind_mps=(0.0, 6.0))
    assert np.abs(flight.position_m[:25] - route[0]).max() < 0.05
    assert flight.tilt_accel_mps2[0] > 2.0


def test_the_step_length_does_not_matter():
    """Steps of 0.01 and 0.02 s agree within 0.03 s per leg."""
    route = flights.mission_route()
    fine = fly_route(route, WpNav(speed_mps=8), step_s=0.01).reached_s
    coarse = fly_route(route, WpNav(speed_mps=8), step_s=0.02).reached_s
    assert np.abs(np.diff(fine) - np.diff(coarse)).max() <= 0.03


def test_unreachable_wind_is_said():
    """A head wind beyond the tilt limit raises InfeasibleError and names the wind."""
    route = np.array([[0.0, 0, 50], [200, 0, 50]])
    with pytest.raises(InfeasibleError, match="wind of 25"):
        fly_route(route, WpNav(), wind_mps=(-25.0, 0.0))
