"""How far the air differs from what was planned with."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_msgs_py.errors import InputError


@dataclass(frozen=True)
class AirSettings:
    """Errors of the channel, dialled in.

    `path_loss_error_db` is lost on every link beyond what the planning channel says (an error in
    μ_f; negative: the air is better). `shadowing_sigma_db` is the standard deviation of log-normal
    shadowing, which decays to 1/e over `shadowing_decorrelation_m` metres of the two ends' motion
    together, or over `shadowing_decorrelation_s` seconds. Raises InputError for values that are no
    such thing.
    """

    path_loss_error_db: float = 0.0
    shadowing_sigma_db: float = 0.0
    shadowing_decorrelation_m: float = 100.0
    shadowing_decorrelation_s: float = 60.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not math.isfinite(self.path_loss_error_db):
            raise InputError(
                f"path_loss_error_db is {self.path_loss_error_db}, must be a finite number of dB."
            )
        if not 0 <= self.shadowing_sigma_db < math.inf:
            raise InputError(
                f"shadowing_sigma_db is {self.shadowing_sigma_db}, must be 0 dB or more."
            )
        for name in ("shadowing_decorrelation_m", "shadowing_decorrelation_s"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}, must be positive.")
