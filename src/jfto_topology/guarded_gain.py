"""Link gains to plan with where powers hold for a whole slot and nothing is known exactly."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array
from jfto_msgs_py.units import db_to_ratio

# Keeps a link that takes all a radio has from being lost by rounding.
_ROUNDING = 1e-9


def guarded_gain(gain: Array, p_max_w: Array, sensitivity_w: float, margin_db: float) -> Array:
    """Gains (M, A, A) that a link has left at the worse end of its slot, less a margin.

    `gain` is (M + 1, A, A) at the slots' beginnings and at the end of the last one, `p_max_w` (A,)
    in watts. A link that the planned gain makes possible at a slot's beginning stays possible, at
    full power: a margin must not take away what is there.
    """
    now, after = gain[:-1], gain[1:]
    guarded = np.minimum(now, after) * db_to_ratio(-margin_db)
    least = sensitivity_w / np.minimum(p_max_w[:, None], p_max_w[None, :]) * (1 + _ROUNDING)
    return np.where(now >= least, np.maximum(guarded, least), guarded)
