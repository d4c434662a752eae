"""What a multirotor may do."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.errors import InputError


@dataclass(frozen=True)
class MotionLimits:
    """Greatest horizontal, climb and descent speeds in m/s."""

    speed_mps: float
    climb_mps: float
    descent_mps: float

    def __post_init__(self) -> None:
        for name in ("speed_mps", "climb_mps", "descent_mps"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}, must be positive.")
