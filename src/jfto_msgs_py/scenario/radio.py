"""The radio link."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.radio import CHANNEL_MODELS, NOISE_READINGS, Radio
from jfto_msgs_py.scenario.key import param

# Short-hand keys and the keys that they set.
RADIO_SHORTHANDS = {"radio.antenna_gain_dbi": ("radio.gain_tx_dbi", "radio.gain_rx_dbi")}


@dataclass(frozen=True)
class RadioPart:
    """The radio that all UAVs carry and the channel between two of them."""

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

    def record(self) -> Radio:
        """The radio as the record that the models take."""
        return Radio(**vars(self))
