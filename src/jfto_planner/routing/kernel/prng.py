"""Random numbers that are the same on every machine (splitmix64, Steele et al. 2014)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array
from jfto_world.compiled import inner

Seed = NDArray[np.uint64]

_STEP = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_S30, _S27, _S31, _S11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_UNIT = 2.0**-53


@inner
def uniform(rng: Seed) -> float:
    """Draw from [0, 1); `rng` is one uint64, advanced in place."""
    rng[0] += _STEP
    z = rng[0]
    z = (z ^ (z >> _S30)) * _MIX_1
    z = (z ^ (z >> _S27)) * _MIX_2
    z ^= z >> _S31
    return float(z >> _S11) * _UNIT


@inner
def below(rng: Seed, count: int) -> int:
    """Draw an integer from 0 … count - 1."""
    return int(uniform(rng) * count)


def exponential_table(size: int) -> Array:
    """Evenly spread quantiles of the unit exponential distribution.

    Looked up in place of a logarithm, whose last digit differs between machines; rounded for the
    same reason.
    """
    chance: Array = (np.arange(size, dtype=np.float64) + 0.5) / size
    quantile: Array = -np.log(chance)
    return quantile.round(9)
