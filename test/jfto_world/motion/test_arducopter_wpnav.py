"""Rules of the parameters of planner and airframe."""

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_world.motion.arducopter import Airframe, WpNav, fly_route


@pytest.mark.parametrize(("tilt_deg", "speed_mps"), [(20.0, 7.40), (22.0, 7.95), (28.7, 9.87)])
def test_top_airspeed_is_the_measured_one(tilt_deg, speed_mps):
    """A tilt limit holds the airspeed that the recorded flights had at that tilt, level."""
    top = Airframe().top_airspeed_mps(WpNav(angle_max_deg=tilt_deg))
    assert top == pytest.approx(speed_mps, abs=0.12)


def test_no_drag_has_no_top_speed():
    """Without drag any airspeed can be held; quadratic drag alone has a simple limit."""
    assert Airframe(0.0, 0.0).top_airspeed_mps(WpNav()) == float("inf")
    limit = (9.80665 * np.sin(np.pi / 6) / 0.05) ** 0.5 / np.cos(np.pi / 6)
    assert Airframe(0.0, 0.05).top_airspeed_mps(WpNav()) == pytest.approx(limit)


def test_flight_at_the_tilt_limit_reaches_the_top_airspeed():
    """Asked for more than its tilt holds, the vehicle flies level at the top airspeed."""
    wpnav = WpNav(speed_mps=20.0, angle_max_deg=20.0)
    flight = fly_route(np.array([[0.0, 0, 50], [2000, 0, 50]]), wpnav)
    cruising = flight.velocity_mps[len(flight.velocity_mps) // 2]
    assert cruising[0] == pytest.approx(Airframe().top_airspeed_mps(wpnav), rel=0.003)


@pytest.mark.parametrize("field", ["drag_linear_1ps", "attitude_lag_s"])
def test_wrong_airframes_are_refused(field):
    """Negative drag and lags raise InputError naming the field."""
    with pytest.raises(InputError, match=field):
        Airframe(**{field: -0.1})


def test_corner_acceleration_defaults_to_twice_the_horizontal_one():
    """0 means twice the acceleration, as WPNAV_ACCEL_C = 0 does; other values are taken."""
    assert WpNav(accel_mps2=2.0).corner_limit_mps2 == 4.0
    assert WpNav(corner_accel_mps2=1.0).corner_limit_mps2 == 1.0
