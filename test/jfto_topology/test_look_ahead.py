"""Breaches of the certificate at predicted positions, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_topology.look_ahead import Danger, Rules, energy_danger, look_ahead
from jfto_world.radio import LogDistanceChannel

# 1 W reaches exactly 100 m.
RULES = Rules(LogDistanceChannel(1.0), np.ones(4), 1e-4, 1, 10.0)
ALL = np.ones((4, 4), dtype=bool)


def _line(*east_m: tuple[float, ...]) -> np.ndarray:
    """Instants by UAVs along a line."""
    positions = np.zeros((len(east_m), len(east_m[0]), 3))
    positions[..., 0] = east_m
    return positions


def test_a_fleet_that_keeps_the_rules_is_in_no_danger() -> None:
    """Neighbours, distance and one piece at every instant."""
    assert look_ahead(_line((0, 50, 100, 150), (0, 60, 120, 180)), RULES, ALL) == []


def test_a_uav_that_falls_back_loses_its_neighbour_and_splits_the_fleet() -> None:
    """From the second instant on; 200 m is 6 dB too far for a reach of 100 m."""
    found = look_ahead(_line((0, 90, 100, 150), (0, 150, 160, 210), (0, 200, 210, 260)), RULES, ALL)
    assert [(each.kind, each.uavs, each.first) for each in found] == [
        ("k_min", (0,), 1),
        ("connectivity", (), 1),
    ]
    assert [each.margin for each in found] == pytest.approx([-6.02, -6.02], abs=0.01)


def test_two_that_come_too_close_are_named_unless_they_are_not_looked_at() -> None:
    """The worst of the stretch is the margin; two on their pads may be close."""
    positions = _line((0, 50, 100, 150), (0, 50, 58, 150), (0, 50, 54, 150))
    assert look_ahead(positions, RULES, ALL) == [Danger("d_min", (1, 2), 1, -6.0)]
    apart = ALL.copy()
    apart[1, 2] = apart[2, 1] = False
    assert look_ahead(positions, RULES, apart) == []


def test_energy_that_does_not_pay_for_the_rest() -> None:
    """Three slots of 2 s at 1 W cost 6 J: 5 J last for two, 6 J for all, and inf is unknown."""
    found = energy_danger(np.ones((3, 3)), 2.0, np.array([5.0, 6.0, np.inf]))
    assert found == [Danger("energy", (0,), 2, -1.0)]
