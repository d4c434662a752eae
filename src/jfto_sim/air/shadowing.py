"""Log-normal shadowing that changes as slowly as the fleet moves."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array
from jfto_sim.air.settings import AirSettings


class Shadowing:
    """Excess loss of every link in dB, reciprocal, from one seed.

    A first-order autoregression per pair: between two looks the old value is kept with
    ρ = exp(-(Δd_a + Δd_b)/d - Δt/τ) and the rest drawn anew, so that the spread is σ however often
    one looks. The same looks give the same bytes. Source: Gudmundson, Correlation model for shadow
    fading in mobile radio systems, Electronics Letters 27 (1991), with both ends moving.
    """

    def __init__(self, uav_count: int, settings: AirSettings) -> None:
        self._settings = settings
        self._rng = np.random.default_rng(settings.seed)
        self._pairs = np.triu_indices(uav_count, 1)
        self._at_m: Array | None = None
        self._loss_db = np.zeros((uav_count, uav_count))

    def step(self, dt_s: float, positions_m: Array) -> Array:
        """Loss (A, A) in dB, zero mean, after `dt_s` seconds at positions (A, 3) in metres."""
        sigma = self._settings.shadowing_sigma_db
        if sigma == 0:
            return self._loss_db
        first, second = self._pairs
        fresh = sigma * self._rng.standard_normal(first.size)
        if self._at_m is None:
            value = fresh
        else:
            moved_m = np.linalg.norm(positions_m - self._at_m, axis=1)
            decay = (moved_m[first] + moved_m[second]) / self._settings.shadowing_decorrelation_m
            kept = np.exp(-decay - dt_s / self._settings.shadowing_decorrelation_s)
            value = kept * self._loss_db[first, second] + np.sqrt(1 - kept**2) * fresh
        self._at_m = positions_m.copy()
        self._loss_db = np.zeros_like(self._loss_db)
        self._loss_db[first, second] = value
        self._loss_db[second, first] = value
        return self._loss_db
