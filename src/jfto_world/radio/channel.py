"""Path gain between two antennas as a function of where they are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import SPEED_OF_LIGHT_MPS, db_to_ratio

# Antennas closer than this are taken to be this far apart: the far-field formula diverges at zero.
NEAR_FIELD_M = 1.0


class Channel(Protocol):
    """A reciprocal channel; every model that plans or simulates the air satisfies this."""

    def gain(self, distance_m: Array) -> Array:
        """Linear power gain h of links of the given length in metres, any shape."""

    def reach(self, power_w: Array, sensitivity_w: float) -> Array:
        """Greatest distance in metres at which a power in watts is still received."""

    def required_power(self, distance_m: Array, sensitivity_w: float) -> Array:
        """Least power in watts that is received over the given distances in metres."""


@dataclass(frozen=True)
class LogDistanceChannel:
    """h = k / d^n, where free space is n = 2 and k = μ_f (eq. hab).

    `gain_at_1_m` is k, linear; `exponent` is n.
    """

    gain_at_1_m: float
    exponent: float = 2.0

    def gain(self, distance_m: Array) -> Array:
        """Linear power gain h of links of the given length in metres, any shape.

        NaN where the length is; raises InputError for lengths below 0.
        """
        if np.any(np.asarray(distance_m) < 0):
            shortest_m = float(np.nanmin(distance_m))
            raise InputError(f"distance_m holds {shortest_m:g} m; lengths of links are 0 or more.")
        return self.gain_at_1_m / np.maximum(distance_m, NEAR_FIELD_M) ** self.exponent

    def reach(self, power_w: Array, sensitivity_w: float) -> Array:
        """Greatest distance in metres at which a power in watts is still received (eq. cab)."""
        return (self.gain_at_1_m * np.asarray(power_w) / sensitivity_w) ** (1 / self.exponent)

    def required_power(self, distance_m: Array, sensitivity_w: float) -> Array:
        """Least power in watts that is received over the given distances in metres (eq. Pmin1)."""
        return sensitivity_w / self.gain(np.asarray(distance_m))


def free_space_gain_at_1_m(radio: Radio) -> float:
    """μ_f = G_tx G_rx (c / 4πf)², less the fade margin."""
    wavelength_m = SPEED_OF_LIGHT_MPS / radio.frequency_hz
    decibels = radio.gain_tx_dbi + radio.gain_rx_dbi - radio.fade_margin_db
    return db_to_ratio(decibels) * (wavelength_m / (4 * math.pi)) ** 2


def make_channel(radio: Radio) -> LogDistanceChannel:
    """Channel model that a radio record asks for.

    Parameters
    ----------
    radio
        Its model and parameters.

    Returns
    -------
    LogDistanceChannel
        With gain, reach and required power.
    """
    exponent = 2.0 if radio.channel == "free_space" else radio.path_loss_exponent
    return LogDistanceChannel(free_space_gain_at_1_m(radio), exponent)
