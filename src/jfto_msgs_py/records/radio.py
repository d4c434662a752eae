"""The radio that all UAVs carry, as a record that crosses borders."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.errors import InputError

NOISE_READINGS = ("total", "per_hertz")
CHANNEL_MODELS = ("free_space", "log_distance")


@dataclass(frozen=True)
class Radio:
    """One kind of mesh radio and the channel between two of them.

    `noise_reading` says what `noise_dbm` is: "total" for σ²B, the noise in the whole band, or
    "per_hertz" for σ², the noise density. `channel` is "free_space" (eq. hab) or "log_distance",
    which loses `path_loss_exponent` × 10 dB per decade beyond 1 m; `fade_margin_db` is subtracted
    from either.
    """

    frequency_hz: float = 2.44e9
    gain_tx_dbi: float = 3.0
    gain_rx_dbi: float = 3.0
    sensitivity_dbm: float = -70.0
    bandwidth_hz: float = 83.5e6
    noise_dbm: float = -110.0
    noise_reading: str = "total"
    channel: str = "free_space"
    path_loss_exponent: float = 2.0
    fade_margin_db: float = 0.0

    def __post_init__(self) -> None:
        if not self.frequency_hz > 0:
            raise InputError(f"radio.frequency_hz is {self.frequency_hz}, must be positive.")
        if not self.bandwidth_hz > 0:
            raise InputError(f"radio.bandwidth_hz is {self.bandwidth_hz}, must be positive.")
        if self.noise_reading not in NOISE_READINGS:
            raise InputError(
                f"radio.noise_reading is {self.noise_reading!r}, must be one of {NOISE_READINGS}."
            )
        if self.channel not in CHANNEL_MODELS:
            raise InputError(f"radio.channel is {self.channel!r}, must be one of {CHANNEL_MODELS}.")
        if not self.path_loss_exponent > 0:
            raise InputError(
                f"radio.path_loss_exponent is {self.path_loss_exponent}, must be positive."
            )
