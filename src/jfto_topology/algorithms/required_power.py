"""Power that each link costs: the one thing C-TOP needs to know about the air."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array
from jfto_world.radio import Channel

# Someone else's distance may differ from ours in the last bits; a link asked for is still a link.
RECEPTION_MARGIN = 1e-12


def required_powers(
    positions_m: Array, channel: Channel, p_max_w: Array, sensitivity_w: float
) -> Array:
    """Power in watts that closes each link, inf where no link is possible.

    `positions_m` is (M, A, 3) and `p_max_w` (A,); the result is (M, A, A), symmetric, with inf on
    the diagonal and between UAVs that cannot both be heard at P_a,max: a link needs
    min(p_a, p_b) h ≥ γ, so a weak UAV is out of reach for a strong one that it cannot answer.
    Raises InputError for shapes or values that make no sense. Source: eq. Pmin1.
    """
    positions_m = np.ascontiguousarray(positions_m, dtype=np.float64)
    if positions_m.ndim != 3 or positions_m.shape[2] != 3 or positions_m.shape[1] < 1:
        raise InputError(f"positions_m has shape {positions_m.shape}, must be (slots, UAVs, 3).")
    if not np.isfinite(positions_m).all():
        raise InputError("positions_m holds values that are not finite, must be ENU metres.")
    p_max_w = checked_caps(p_max_w, positions_m.shape[1])
    checked_sensitivity(sensitivity_w)
    first, second = np.triu_indices(positions_m.shape[1], 1)
    x, y, z = np.moveaxis(positions_m[:, first] - positions_m[:, second], -1, 0)
    return _required(channel.gain(np.sqrt(x * x + y * y + z * z)), p_max_w, float(sensitivity_w))


def required_powers_of_gain(gain: Array, p_max_w: Array, sensitivity_w: float) -> Array:
    """Power in watts that closes each link of a measured or modelled gain, (M, A, A).

    As `required_powers`, for air that is not a function of distance; only the upper triangle of
    `gain` is read, the channel being reciprocal.
    """
    gain = np.asarray(gain, dtype=np.float64)
    if gain.ndim != 3 or gain.shape[1] != gain.shape[2] or gain.shape[1] < 1:
        raise InputError(f"gain has shape {gain.shape}, must be (slots, UAVs, UAVs).")
    if not (np.isfinite(gain).all() and (gain >= 0).all()):
        raise InputError("gain holds values that are negative or not finite.")
    first, second = np.triu_indices(gain.shape[1], 1)
    p_max_w = checked_caps(p_max_w, gain.shape[1])
    checked_sensitivity(sensitivity_w)
    return _required(gain[:, first, second], p_max_w, float(sensitivity_w))


def checked_caps(p_max_w: Array, uav_count: int) -> Array:
    """P_a,max as a float array (A,); raises InputError unless positive and one per UAV."""
    p_max_w = np.ascontiguousarray(p_max_w, dtype=np.float64)
    if p_max_w.shape != (uav_count,):
        raise InputError(f"p_max_w has shape {p_max_w.shape}, must be ({uav_count},).")
    if not (np.isfinite(p_max_w).all() and (p_max_w > 0).all()):
        raise InputError(f"p_max_w is {p_max_w.tolist()}, must be positive watts.")
    return p_max_w


def checked_sensitivity(sensitivity_w: float) -> None:
    """Raise InputError unless γ is a positive power."""
    if not (sensitivity_w > 0 and np.isfinite(sensitivity_w)):
        raise InputError(f"sensitivity_w is {sensitivity_w}, must be positive watts.")


def _required(pair_gain: Array, p_max_w: Array, sensitivity_w: float) -> Array:
    """Powers (M, A, A) from the gains (M, pairs) of the upper triangle."""
    uavs = len(p_max_w)
    first, second = np.triu_indices(uavs, 1)
    cap = np.minimum(p_max_w[first], p_max_w[second])
    with np.errstate(divide="ignore", over="ignore"):
        # At the very edge of reach the margin must not ask for more than the cap.
        power = np.minimum(sensitivity_w / pair_gain * (1.0 + RECEPTION_MARGIN), cap)
    power = np.where(cap * pair_gain >= sensitivity_w, power, np.inf)
    required = np.full((len(pair_gain), uavs, uavs), np.inf)
    required[:, first, second] = power
    required[:, second, first] = power
    return required
