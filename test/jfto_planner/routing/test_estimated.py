"""Time models reduced to leg estimates."""

from __future__ import annotations

import numpy as np

from jfto_planner.routing import Calibrated, Estimated, calibrated
from jfto_world.motion import ConstantSpeed, MotionLimits
from jfto_world.motion.arducopter import ArduCopter

_LINE = np.array([[0.0, 0, 0], [100, 0, 10], [100, 80, 0], [0, 80, 30]])
_LIMITS = MotionLimits(8.0, 4.0, 3.0)


def test_the_estimate_of_constant_speed_is_exact() -> None:
    """Where legs are all there is, adding them up changes nothing."""
    model, times = ConstantSpeed(), np.linspace(0.0, 60.0, 50)
    estimate = Estimated(model)
    assert np.allclose(estimate.arrivals(_LINE, _LIMITS), model.arrivals(_LINE, _LIMITS))
    expected = model.positions(_LINE, _LIMITS, times)
    assert np.allclose(estimate.positions(_LINE, _LIMITS, times), expected)


def test_a_factor_scales_the_estimate_and_leaves_the_flight() -> None:
    """Calibration corrects what the search goes by, never the times that count."""
    model = ArduCopter(takeoff_m=10.0)
    slower = Calibrated(model, 1.1)
    assert np.array_equal(slower.arrivals(_LINE, _LIMITS), model.arrivals(_LINE, _LIMITS))
    estimated = Estimated(model).arrivals(_LINE, _LIMITS)
    assert np.allclose(Estimated(slower).arrivals(_LINE, _LIMITS), 1.1 * estimated)


def test_a_uav_without_waypoints_is_done_at_once() -> None:
    """It stays on its pad and has no overhead."""
    estimate = Estimated(ArduCopter(takeoff_m=10.0))
    assert estimate.arrivals(_LINE[:1], _LIMITS).tolist() == [0.0]
    assert np.array_equal(
        estimate.positions(_LINE[:1], _LIMITS, np.array([0.0, 9.0])), _LINE[[0, 0]]
    )


def test_the_factor_follows_the_speed_where_flights_tell() -> None:
    """Fast UAVs at 0.92 and slow ones at 0.96 of the estimate; those on their pads do not count."""
    model = ArduCopter()
    speeds, expected = np.array([8.0, 8, 7, 7, 6]), np.array([400.0, 300, 400, 350, 0])
    flown = np.array([0.92, 0.92, 0.96, 0.96, 0.0]) * expected
    found = calibrated(model, speeds, flown, expected)

    def factor(speed_mps: float) -> float:
        limits = MotionLimits(speed_mps, 4.0, 3.0)
        estimate = Estimated(model).arrivals(_LINE, limits)[-1]
        return float(Estimated(found).arrivals(_LINE, limits)[-1] / estimate)

    assert np.allclose([factor(8.0), factor(7.5), factor(7.0)], [0.92, 0.94, 0.96])
    # Nobody flew that fast or slowly: the line is not prolonged.
    assert np.allclose([factor(20.0), factor(2.0)], [0.92, 0.96])
    assert calibrated(model, np.full(5, 8.0), 0.9 * expected, expected) == Calibrated(model, 0.9)
    assert calibrated(model, speeds, 0.0 * expected, 0.0 * expected) == Calibrated(model)


def test_few_uavs_share_one_factor() -> None:
    """Three flights do not tell how it depends on the speed."""
    speeds, expected = np.array([8.0, 7, 6, 5]), np.array([400.0, 300, 100, 0])
    flown = np.array([0.9, 1.0, 1.1, 0.0]) * expected
    assert calibrated(ArduCopter(), speeds, flown, expected).per_mps == 0.0
    assert np.isclose(calibrated(ArduCopter(), speeds, flown, expected).factor, 770 / 800)
