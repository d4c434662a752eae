"""Constants of nature, and conversions between decibels and linear units."""

from __future__ import annotations

from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

SPEED_OF_LIGHT_MPS = 299_792_458.0
GRAVITY_MPS2 = 9.80665


@overload
def dbm_to_w(dbm: float) -> float: ...
@overload
def dbm_to_w(dbm: ArrayLike) -> NDArray[np.float64]: ...
def dbm_to_w(dbm):  # type: ignore[no-untyped-def]
    """Power in watts of a level in dBm."""
    return 10.0 ** ((np.asarray(dbm, dtype=float) - 30.0) / 10.0)[()]


@overload
def w_to_dbm(watt: float) -> float: ...
@overload
def w_to_dbm(watt: ArrayLike) -> NDArray[np.float64]: ...
def w_to_dbm(watt):  # type: ignore[no-untyped-def]
    """Level in dBm of a power in watts; -inf for 0 W."""
    with np.errstate(divide="ignore"):
        return (10.0 * np.log10(np.asarray(watt, dtype=float)) + 30.0)[()]


@overload
def db_to_ratio(db: float) -> float: ...
@overload
def db_to_ratio(db: ArrayLike) -> NDArray[np.float64]: ...
def db_to_ratio(db):  # type: ignore[no-untyped-def]
    """Linear power ratio of a value in dB."""
    return 10.0 ** (np.asarray(db, dtype=float) / 10.0)[()]


@overload
def ratio_to_db(ratio: float) -> float: ...
@overload
def ratio_to_db(ratio: ArrayLike) -> NDArray[np.float64]: ...
def ratio_to_db(ratio):  # type: ignore[no-untyped-def]
    """Decibel value of a linear power ratio; -inf for 0."""
    with np.errstate(divide="ignore"):
        return (10.0 * np.log10(np.asarray(ratio, dtype=float)))[()]
