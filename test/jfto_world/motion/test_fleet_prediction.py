"""The plan re-anchored at measured poses."""

from __future__ import annotations

import numpy as np
import pytest

from support.fleets import at, column, pose


def test_without_poses_the_plan_is_the_prediction() -> None:
    """Positions at given instants are the planned ones, in the order of the UAVs asked for."""
    predicted = column(2).positions(("uav2", "uav1"), np.array([at(4.0), at(30.0)]))
    np.testing.assert_allclose(predicted[0], [[20, 100, 50], [20, 0, 50]])
    np.testing.assert_allclose(predicted[1], [[100, 100, 50], [100, 0, 50]])


def test_a_late_uav_shifts_in_time_not_in_space() -> None:
    """Measured 10 m behind at 5 m/s, it is 2 s late, and stays on its line 2 s late."""
    fleet = column(1)
    fleet.set_pose("uav1", pose(6.0, 20.0, 3.0))
    assert fleet.lag_s("uav1") == pytest.approx(2.0)
    later = fleet.positions(("uav1",), np.array([at(10.0)]))[0, 0]
    np.testing.assert_allclose(later, [40, 0, 50])


def test_waiting_on_the_pad_is_no_lag_before_the_start() -> None:
    """A UAV that stands at its start before time zero is on time."""
    fleet = column(1)
    fleet.set_pose("uav1", pose(-5.0, 0.0, 0.0))
    assert fleet.lag_s("uav1") == 0.0


def test_old_poses_are_not_taken() -> None:
    """Out-of-order telemetry does not move a UAV back."""
    fleet = column(1)
    assert fleet.set_pose("uav1", pose(6.0, 30.0, 0.0))
    assert not fleet.set_pose("uav1", pose(5.0, 0.0, 0.0))
    assert fleet.lag_s("uav1") == pytest.approx(0.0)


def test_freshness_is_measured_by_the_stamp() -> None:
    """A pose older than the limit, or none at all, is not fresh."""
    fleet = column(3)
    fleet.set_pose("uav1", pose(5.0, 25.0, 0.0))
    fleet.set_pose("uav2", pose(2.0, 10.0, 100.0))
    assert fleet.fresh(at(6.0), 3.0) == ("uav1",)
