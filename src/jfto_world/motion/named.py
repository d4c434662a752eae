"""Time models by the name that a plan carries."""

from __future__ import annotations

from jfto_msgs_py.errors import InputError
from jfto_world.motion.constant_speed import ConstantSpeed
from jfto_world.motion.time_model import TimeModel

_MODELS = {"constant_speed": ConstantSpeed}


def time_model_named(name: str) -> TimeModel:
    """Return the time model of a name; raises InputError that lists the known names."""
    if name not in _MODELS:
        raise InputError(f"time_model is {name!r}, must be one of {', '.join(sorted(_MODELS))}.")
    return _MODELS[name]()
