"""The radio that all UAVs carry, as a part of the scenario and a record that crosses borders."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.fields import param

NOISE_READINGS = ("total", "per_hertz")
CHANNEL_MODELS = ("free_space", "log_distance")


@dataclass(frozen=True)
class Radio:
    """The radio that all UAVs carry and the channel between two of them.

    `noise_reading` says what `noise_dbm` is: "total" for σ²B, the noise in the whole band, or
    "per_hertz" for σ², the noise density. `channel` is "free_space" (eq. hab) or "log_distance",
    which loses `path_loss_exponent` × 10 dB per decade beyond 1 m; `fade_margin_db` is subtracted
    from either.
    """

    frequency_hz: float = param(2.44e9, "Carrier frequency.", unit="Hz", low=1e6, high=1e11)
    gain_tx_dbi: float = param(
        3.0, "Gain of the sending antenna.", unit="dBi", low=-20.0, high=40.0
    )
    gain_rx_dbi: float = param(
        3.0, "Gain of the receiving antenna.", unit="dBi", low=-20.0, high=40.0
    )
    sensitivity_dbm: float = param(
        -70.0, "Received power that makes a link, γ.", unit="dBm", low=-150.0, high=0.0
    )
    bandwidth_hz: float = param(83.5e6, "Bandwidth, B.", unit="Hz", low=1e3, high=1e10)
    noise_dbm: float = param(
        -110.0, "Noise power, read as radio.noise_reading says.", unit="dBm", low=-220.0, high=0.0
    )
    noise_reading: str = param(
        "total",
        "total: noise_dbm is σ²B, in the whole band; per_hertz: it is σ², the density.",
        choices=NOISE_READINGS,
    )
    channel: str = param(
        "free_space",
        "Path loss: free_space (exponent 2), or log_distance with radio.path_loss_exponent.",
        choices=CHANNEL_MODELS,
    )
    path_loss_exponent: float = param(
        2.0, "Exponent of the log-distance channel.", low=1.0, high=6.0
    )
    fade_margin_db: float = param(
        0.0, "Loss added to every link for fading.", unit="dB", low=0.0, high=60.0
    )

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
