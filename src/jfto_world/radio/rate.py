"""What a link carries."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import dbm_to_w


def noise_w(radio: Radio) -> float:
    """Noise power in the whole band, σ²B, in watts, in the radio's reading of `noise_dbm`."""
    power = float(dbm_to_w(radio.noise_dbm))
    return power if radio.noise_reading == "total" else power * radio.bandwidth_hz


def rate_bps(radio: Radio, power_w: Array, gain: Array) -> Array:
    """Capacity R = B log2(1 + p h / σ²B) in bit/s (eq. Rab); arguments broadcast."""
    return radio.bandwidth_hz * np.log1p(power_w * gain / noise_w(radio)) / np.log(2.0)
