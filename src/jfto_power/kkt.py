"""How far an allocation is from the optimality conditions of (P4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array
from jfto_power.allocation import PowerProblem
from jfto_world.radio import noise_w


def objective_bps(adjacency: NDArray[np.bool_], gain: Array, power_w: Array, radio: Radio) -> float:
    """Σ_{n=1..N} Σ over ordered linked pairs of B log2(1 + p h / σ²B), in bit/s (P2obj)."""
    snr = power_w[1:, :, None] * gain[1:] / noise_w(radio)
    bits = np.where(adjacency[1:], np.log1p(snr), 0.0).sum()
    return float(radio.bandwidth_hz * bits / np.log(2.0))


def kkt_residual(problem: PowerProblem, power_w: Array, multiplier: Array) -> float:
    """Largest violation of the Karush-Kuhn-Tucker conditions, as a number without unit.

    `power_w` is (N + 1, A) and `multiplier` (A,), as in `Allocation`; slots 1..N are judged.
    Parts, each divided by its natural scale: bounds, by p_high; energy, by the budget; the sign of
    the multiplier, by the greatest slope; multiplier × unspent energy, by Σ slope × power; and per
    slot and UAV the stationarity
    min(|slope - λ| / max(slope, λ), way left to the bound it presses against / p_high). Zero
    exactly at the optimum, and unchanged by the units of power, energy and rate.
    """
    low, high, power = problem.p_low_w[1:], problem.p_high_w[1:], power_w[1:]
    radio, slot_s = problem.radio, problem.slot_duration_s
    budget_w = problem.energy_j / slot_s
    with np.errstate(divide="ignore"):
        zero_db_w = np.where(problem.adjacency[1:], noise_w(radio) / problem.gain[1:], np.inf)
    slope = (1.0 / (power[:, :, None] + zero_db_w)).sum(axis=2)
    price = multiplier * slot_s * np.log(2.0) / radio.bandwidth_hz
    span = np.where(high > 0, high, 1.0)
    spent_w = power.sum(axis=0)
    scale = np.maximum(budget_w, np.where(spent_w > 0, spent_w, 1.0))
    steep = np.maximum(slope, price)
    wish = np.where(steep > 0, (slope - price) / np.where(steep > 0, steep, 1.0), 0.0)
    room = np.where(wish > 0, high - power, power - low) / span
    worth = (slope * power).sum(axis=0)
    unspent = np.where(worth > 0, price * (budget_w - spent_w) / np.where(worth > 0, worth, 1), 0)
    parts = [
        (low - power) / span,
        (power - high) / span,
        (spent_w - budget_w) / scale,
        -price / np.where(slope.max(axis=0, initial=0) > 0, slope.max(axis=0, initial=0), 1.0),
        np.abs(unspent),
        np.minimum(np.abs(wish), np.maximum(room, 0.0)),
    ]
    return float(max(np.max(part, initial=0.0) for part in parts))
