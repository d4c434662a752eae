"""The time model of ways home: the autopilot's legs, without lift-off or holds."""

from __future__ import annotations

from collections.abc import Mapping

from jfto_world.motion.named import time_model_named
from jfto_world.motion.time_model import TimeModel

# Of a mission's parameters, what ways home have none of; of a curve's, what the autopilot's legs
# have too.
_NOT_HOME = ("hold_s", "takeoff_m")
_OF_CURVES = ("accel_z_mps2",)


def home_model(name: str, parameters: Mapping[str, float]) -> TimeModel:
    """Time model of the ways home of a plan with this time model and its parameters.

    After curves, too, the autopilot flies home by itself, as it is released but for the vertical
    acceleration. Raises InputError.
    """
    if name == "bezier":
        return time_model_named("arducopter", {k: parameters[k] for k in _OF_CURVES})
    return time_model_named(name, {k: v for k, v in parameters.items() if k not in _NOT_HOME})
