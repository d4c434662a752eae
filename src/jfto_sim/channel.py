"""What the air does to a link beyond its planned gain, and how many packets arrive."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import SPEED_OF_LIGHT_MPS

# Height of the ground in metres of the ENU frame at metres east and north, arrays of one shape.
Ground = Callable[[Array, Array], Array]
# Points looked at along a link, its ends left out.
_PROFILE_POINTS = 64
# Below this ν a knife edge takes nothing away.
_CLEAR_V = -0.78
# A receiver's sensitivity is the level at which a tenth of the packets is lost (IEEE 802.11).
AT_SENSITIVITY = 0.9
# Odds of delivery change by e per this many dB: from 10 % lost to 1 % in 2.4 dB.
SLOPE_DB = 1.0


@dataclass(frozen=True)
class AirSettings:
    """Errors of the channel, dialled in.

    `path_loss_error_db` is lost on every link beyond what the planning channel says (an error in
    μ_f; negative: the air is better). `shadowing_sigma_db` is the standard deviation of log-normal
    shadowing, which decays to 1/e over `shadowing_decorrelation_m` metres of the two ends' motion
    together, or over `shadowing_decorrelation_s` seconds. Raises InputError for values that are no
    such thing.
    """

    path_loss_error_db: float = 0.0
    shadowing_sigma_db: float = 0.0
    shadowing_decorrelation_m: float = 100.0
    shadowing_decorrelation_s: float = 60.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not math.isfinite(self.path_loss_error_db):
            raise InputError(
                f"path_loss_error_db is {self.path_loss_error_db}, must be a finite number of dB."
            )
        if not 0 <= self.shadowing_sigma_db < math.inf:
            raise InputError(
                f"shadowing_sigma_db is {self.shadowing_sigma_db}, must be 0 dB or more."
            )
        for name in ("shadowing_decorrelation_m", "shadowing_decorrelation_s"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}, must be positive.")


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


def knife_edge_loss_db(v: Array) -> Array:
    """J(ν), loss behind a knife edge in dB, 0 where ν ≤ -0.78. Source: ITU-R P.526, eq. 31."""
    shifted = np.maximum(v, _CLEAR_V) - 0.1
    loss = 6.9 + 20 * np.log10(np.sqrt(shifted**2 + 1) + shifted)
    return np.where(v > _CLEAR_V, np.maximum(loss, 0.0), 0.0)


def terrain_loss_db(positions_m: Array, ground: Ground, frequency_hz: float) -> Array:
    """Loss of every pair by its worst single edge in dB, (A, A), symmetric, 0 on the diagonal.

    `positions_m` is (A, 3) in the frame that `ground` is in. One edge only: a lower bound behind
    several ridges.
    """
    count = len(positions_m)
    first, second = np.triu_indices(count, 1)
    share = np.linspace(0, 1, _PROFILE_POINTS + 2)[1:-1]
    a, b = positions_m[first], positions_m[second]
    points = a[:, None, :] + share[None, :, None] * (b - a)[:, None, :]
    above = ground(points[..., 0], points[..., 1]) - points[..., 2]
    length = np.maximum(np.linalg.norm(b - a, axis=1), 1.0)[:, None]
    wavelength_m = SPEED_OF_LIGHT_MPS / frequency_hz
    v = above * np.sqrt(2 / (wavelength_m * length * share * (1 - share)))
    loss = np.zeros((count, count))
    loss[first, second] = loss[second, first] = knife_edge_loss_db(v.max(axis=1, initial=-np.inf))
    return loss


def delivery_share(margin_db: Array) -> Array:
    """Share of packets that arrive, logistic in dB above the sensitivity, any shape.

    0.9 at the sensitivity, 0.99 at 2.4 dB above it, 0.5 at 2.2 dB below; 0 for -inf.
    """
    odds_db = np.log(AT_SENSITIVITY / (1 - AT_SENSITIVITY)) * SLOPE_DB
    # Beyond ±700 the exponential leaves the range of floats.
    exponent = np.clip((np.asarray(margin_db) + odds_db) / SLOPE_DB, -700.0, 700.0)
    return np.where(np.isneginf(margin_db), 0.0, 1 / (1 + np.exp(-exponent)))
