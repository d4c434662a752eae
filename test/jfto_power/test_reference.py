"""The general solver that the exact one is checked against."""

import numpy as np
import pytest

from jfto_msgs_py.records.radio import Radio
from jfto_power.allocation import PowerProblem, allocate
from jfto_power.kkt import objective_bps
from jfto_power.reference import ReferenceAllocator
from jfto_power.shortage import EnergyShortage


@pytest.mark.parametrize("reading", ["total", "per_hertz"])
def test_gains_of_a_hundred_million_are_solved(reading):
    """Signal 80 dB over the noise, where the problem as printed fails, gives the optimum."""
    radio = Radio(noise_reading=reading)
    rng = np.random.default_rng(1)
    linked = ~np.eye(3, dtype=bool)[None].repeat(9, axis=0)
    linked[:, range(3), range(3)] = False
    gain = 10 ** rng.uniform(-7, -5, (9, 3, 3))
    low, high = np.full((9, 3), 0.1), np.full((9, 3), 0.9)
    case = PowerProblem(linked, gain, low, high, np.array([2.0, 4.0, 9.0]), 1.0, radio)
    general = objective_bps(linked, gain, ReferenceAllocator().solve(case), radio)
    exact = objective_bps(linked, gain, allocate(case).power_w, radio)
    assert general == pytest.approx(exact, rel=1e-7)


def test_shortage_is_said_before_solving():
    """The general solver refuses the same budgets as the exact one."""
    case = (np.ones((2, 1, 1), dtype=bool), np.ones((2, 1, 1)), np.ones((2, 1)), np.ones((2, 1)))
    with pytest.raises(EnergyShortage, match=r"uav1 lacks 0\.5 J"):
        ReferenceAllocator().solve(PowerProblem(*case, np.array([0.5]), 1.0, Radio()))
