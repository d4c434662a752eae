"""How many packets arrive."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array

# A receiver's sensitivity is the level at which a tenth of the packets is lost (IEEE 802.11).
AT_SENSITIVITY = 0.9
# Odds of delivery change by e per this many dB: from 10 % lost to 1 % in 2.4 dB.
SLOPE_DB = 1.0


def delivery_share(margin_db: Array) -> Array:
    """Share of packets that arrive, logistic in dB above the sensitivity, any shape.

    0.9 at the sensitivity, 0.99 at 2.4 dB above it, 0.5 at 2.2 dB below; 0 for -inf.
    """
    odds_db = np.log(AT_SENSITIVITY / (1 - AT_SENSITIVITY)) * SLOPE_DB
    # Beyond ±700 the exponential leaves the range of floats.
    exponent = np.clip((np.asarray(margin_db) + odds_db) / SLOPE_DB, -700.0, 700.0)
    return np.where(np.isneginf(margin_db), 0.0, 1 / (1 + np.exp(-exponent)))
