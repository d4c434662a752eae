"""The yardstick of optimality must itself tell right from wrong."""

from dataclasses import replace

import numpy as np
import pytest

from jfto_msgs_py.records.radio import Radio
from jfto_power.allocation import PowerProblem, allocate
from jfto_power.kkt import kkt_residual, objective_bps
from jfto_world.radio import noise_w

RADIO = Radio()
LINKED = np.ones((3, 1, 1), dtype=bool)
GAIN = noise_w(RADIO) / np.array([1.0, 0.1, 0.3]).reshape(3, 1, 1)
LOW, HIGH, ENERGY = np.zeros((3, 1)), np.ones((3, 1)), np.array([0.5])
PROBLEM = PowerProblem(LINKED, GAIN, LOW, HIGH, ENERGY, 1.0, RADIO)


def residual(power_w, multiplier):
    powers = np.array(power_w).reshape(3, 1)
    return kkt_residual(PROBLEM, powers, np.array([multiplier]))


def price(level_w):
    return RADIO.bandwidth_hz / np.log(2) / level_w


def test_residual_vanishes_at_the_known_optimum():
    """Powers 0.35 and 0.15 W at level 0.45 W satisfy all conditions."""
    assert residual([0, 0.35, 0.15], price(0.45)) < 1e-14


@pytest.mark.parametrize(
    ("power_w", "level_w"),
    [
        ([0, 0.25, 0.25], 0.45),  # not stationary
        ([0, 0.35, 0.15], 0.5),  # wrong price
        ([0, 0.36, 0.16], 0.46),  # overdrawn
        ([0, 0.30, 0.10], 0.40),  # energy left although it has a price
        ([0, 0.60, -0.1], 0.45),  # below a bound
        ([0, 0.35, 0.15], -0.45),  # negative price
    ],
)
def test_residual_sees_each_kind_of_violation(power_w, level_w):
    """Any broken condition shows at its natural scale."""
    assert residual(power_w, price(level_w)) > 1e-2


def test_residual_does_not_depend_on_units():
    """A thousandfold of power, noise and energy leaves the residual of a wrong answer as it is."""
    loud = Radio(noise_dbm=RADIO.noise_dbm + 30)
    power = np.array([0, 0.3, 0.2]).reshape(3, 1)
    here = kkt_residual(PROBLEM, power, np.array([price(0.45)]))
    louder = PowerProblem(LINKED, GAIN, 1e3 * LOW, 1e3 * HIGH, 1e3 * ENERGY, 1.0, loud)
    there = kkt_residual(louder, 1e3 * power, np.array([price(450)]))
    assert there == pytest.approx(here)


def test_objective_counts_ordered_pairs_from_slot_one():
    """Two linked UAVs at 0 dB over the noise give one bit per hertz each way and slot."""
    linked = np.zeros((3, 2, 2), dtype=bool)
    linked[:, 0, 1] = linked[:, 1, 0] = True
    gain = np.full((3, 2, 2), noise_w(RADIO))
    total = objective_bps(linked, gain, np.ones((3, 2)), RADIO)
    assert total == pytest.approx(2 * 2 * RADIO.bandwidth_hz)


def test_multiplier_predicts_the_worth_of_a_little_more_energy():
    """The price of energy is the slope of the best throughput."""
    best = allocate(PROBLEM)
    more = allocate(replace(PROBLEM, energy_j=ENERGY + 1e-6))
    gained = objective_bps(LINKED, GAIN, more.power_w, RADIO) - objective_bps(
        LINKED, GAIN, best.power_w, RADIO
    )
    assert gained / 1e-6 == pytest.approx(best.multiplier[0], rel=1e-4)
