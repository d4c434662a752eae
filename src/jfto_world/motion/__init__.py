"""How a multirotor moves along its route, and when it is where."""

from jfto_world.motion.named import time_model_named
from jfto_world.motion.time_model import ConstantSpeed, MotionLimits, TimeModel

__all__ = ["ConstantSpeed", "MotionLimits", "TimeModel", "time_model_named"]
