"""Time models by name."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_world.motion import ConstantSpeed, MotionLimits, time_model_named
from jfto_world.motion.arducopter import ArduCopter, WpNav


def test_a_model_is_rebuilt_from_its_parameters() -> None:
    """Name and parameters, as a plan carries them, give the very same times."""
    model = ArduCopter(WpNav(accel_mps2=2.0, radius_m=1.2), hold_s=1.0, takeoff_m=12.0)
    again = time_model_named("arducopter", model.parameters())
    assert again == model
    line = np.array([[0.0, 0, 0], [80, 0, 30], [80, 90, 20]])
    limits = MotionLimits(8.0, 4.0, 3.0)
    assert np.array_equal(again.arrivals(line, limits), model.arrivals(line, limits))


def test_speeds_are_not_among_the_parameters() -> None:
    """The three speeds belong to each vehicle, not to the fleet's model."""
    assert not [name for name in ArduCopter().parameters() if "speed" in name]


def test_constant_speed_takes_no_parameters() -> None:
    """A parameter that nothing would heed is refused by name."""
    assert isinstance(time_model_named("constant_speed"), ConstantSpeed)
    with pytest.raises(InputError, match="hold_s"):
        time_model_named("constant_speed", {"hold_s": 1.0})


@pytest.mark.parametrize(
    ("name", "parameters", "said"),
    [("warp", {}, "warp"), ("arducopter", {"wrap": 1.0}, "wrap"), ("bezier", {}, "bezier")],
)
def test_what_is_unknown_is_named(name: str, parameters: dict[str, float], said: str) -> None:
    """Unknown models and parameters are refused, each by its name."""
    with pytest.raises(InputError, match=said):
        time_model_named(name, parameters)
