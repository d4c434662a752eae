"""Rules of the parameters of planner and airframe."""

import pytest

from jfto_msgs_py.errors import InputError
from jfto_world.motion.arducopter import Airframe, WpNav


@pytest.mark.parametrize(("tilt_deg", "speed_mps"), [(30.0, 9.9), (20.0, 7.3)])
def test_top_airspeed_is_the_measured_one(tilt_deg, speed_mps):
    """30° of tilt hold 9.9 m/s, 20° hold 7.3 m/s."""
    top = Airframe().top_airspeed_mps(WpNav(angle_max_deg=tilt_deg))
    assert top == pytest.approx(speed_mps, abs=0.2)
    assert Airframe().drag_mps2(top) == pytest.approx(WpNav(angle_max_deg=tilt_deg).tilt_accel_mps2)


def test_no_drag_has_no_top_speed():
    """Without drag any airspeed can be held; linear drag alone has a simple limit."""
    assert Airframe(0.0, 0.0).top_airspeed_mps(WpNav()) == float("inf")
    linear = Airframe(0.5, 0.0)
    assert linear.top_airspeed_mps(WpNav()) == pytest.approx(WpNav().tilt_accel_mps2 / 0.5)


@pytest.mark.parametrize("field", ["drag_linear_1ps", "attitude_lag_s"])
def test_wrong_airframes_are_refused(field):
    """Negative drag and lags raise InputError naming the field."""
    with pytest.raises(InputError, match=field):
        Airframe(**{field: -0.1})


def test_corner_acceleration_defaults_to_twice_the_horizontal_one():
    """0 means twice the acceleration, as WPNAV_ACCEL_C = 0 does; other values are taken."""
    assert WpNav(accel_mps2=2.0).corner_limit_mps2 == 4.0
    assert WpNav(corner_accel_mps2=1.0).corner_limit_mps2 == 1.0
