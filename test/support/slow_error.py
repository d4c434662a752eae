"""Errors that drift: a receiver's idea of where it is, a vehicle's lag behind its plan."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array

# Waves per channel: enough for the sum to be close to normal.
_WAVES = 8


class SlowError:
    """Smooth, near-normal random functions of time, `channels` of them, zero mean, from a seed.

    Each is a sum of equal waves of random phase with periods from `period_s` to five times that;
    its value at a time does not depend on when else it was asked. `sigma` is in the caller's unit.
    """

    def __init__(self, channels: int, sigma: float, period_s: float, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self._amplitude = sigma * np.sqrt(2 / _WAVES)
        self._rate = 2 * np.pi / (period_s * rng.uniform(1, 5, (channels, _WAVES)))
        self._phase = rng.uniform(0, 2 * np.pi, (channels, _WAVES))

    def at(self, time_s: float) -> Array:
        """Values (channels,) at a time in seconds."""
        waves = np.cos(self._rate * time_s + self._phase)
        return np.asarray(self._amplitude * waves.sum(axis=1))
