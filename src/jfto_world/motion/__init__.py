"""How a multirotor moves along its route, and when it is where."""

from jfto_world.motion.constant_speed import ConstantSpeed
from jfto_world.motion.limits import MotionLimits
from jfto_world.motion.named import time_model_named
from jfto_world.motion.time_model import TimeModel

__all__ = ["ConstantSpeed", "MotionLimits", "TimeModel", "time_model_named"]
