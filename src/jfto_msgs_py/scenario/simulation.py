"""What simulated flight does worse than the plan: the errors that can be dialled in."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param


@dataclass(frozen=True)
class SimulationPart:
    """Errors of simulated vehicles and of the air between them; a plan does not depend on them."""

    path_loss_error_db: float = param(
        0.0,
        "Loss of every link beyond the planned channel's, the error in μ_f; below 0: less loss.",
        unit="dB",
        low=-40.0,
        high=40.0,
        hashed=False,
    )
    shadowing_sigma_db: float = param(
        0.0, "Standard deviation of log-normal shadowing.", unit="dB", low=0.0, high=20.0,
        hashed=False,
    )  # fmt: skip
    shadowing_decorrelation_m: float = param(
        100.0,
        "Motion of a link's two ends together over which its shadowing decays to 1/e.",
        unit="m",
        low=0.0,
        high=10_000.0,
        strict=True,
        hashed=False,
    )
    terrain_loss: bool = param(
        False, "Ridges between two UAVs attenuate their link (one knife edge).", hashed=False
    )
    position_error_m: float = param(
        0.0,
        "Standard deviation of reported positions, east and north, correlated over 3 s.",
        unit="m",
        low=0.0,
        high=100.0,
        hashed=False,
    )
    time_error_s: float = param(
        0.0,
        "How late vehicles begin their missions: σ of a half-normal draw.",
        unit="s",
        low=0.0,
        high=10.0,
        hashed=False,
    )
    seed: int = param(0, "Seed of all errors.", low=0, high=2**31 - 1, hashed=False)
