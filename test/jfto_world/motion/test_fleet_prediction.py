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
    assert fleet.lag_s("uav1") == pytest.approx(2.0, abs=1e-3)
    later = fleet.positions(("uav1",), np.array([at(10.0)]))[0, 0]
    np.testing.assert_allclose(later, [40, 0, 50], atol=1e-2)


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


def test_one_held_up_uav_does_not_move_the_fleet() -> None:
    """The fleet's lag is the median of those under way; who has not been measured has none."""
    fleet = column(4)
    assert fleet.fleet_lag_s(fleet.uav_ids) is None
    for index, east_m in enumerate((30.0, 29.0, 5.0)):
        fleet.set_pose(f"uav{index + 1}", pose(6.0, east_m, 100.0 * index))
    assert fleet.fleet_lag_s(fleet.uav_ids) == pytest.approx(0.2, abs=1e-3)
    assert fleet.lag_s("uav3") == pytest.approx(5.0, abs=1e-3)


def test_who_has_left_its_route_stays_where_it_was_measured() -> None:
    """Predicted at the place measured last, at every instant; the others along their routes."""
    fleet = column(2)
    for step in range(6):
        fleet.set_pose("uav1", pose(5.0 + step, 25.0, 400.0 + step))
        fleet.set_pose("uav2", pose(5.0 + step, 25.0 + 5 * step, 100.0))
    assert fleet.is_off_route("uav1")
    assert not fleet.is_off_route("uav2")
    predicted = fleet.positions(("uav1", "uav2"), np.array([at(10.0), at(16.0)]))
    np.testing.assert_allclose(predicted[:, 0], [[25, 405, 50], [25, 405, 50]])
    np.testing.assert_allclose(predicted[:, 1], [[50, 100, 50], [80, 100, 50]], atol=1e-2)


def test_a_clock_that_was_set_back_begins_anew() -> None:
    """Poses with earlier stamps count again once those before are forgotten."""
    fleet = column(1)
    fleet.set_pose("uav1", pose(15.0, 75.0, 0.0))
    assert not fleet.set_pose("uav1", pose(6.0, 20.0, 0.0))
    fleet.forget_poses()
    assert fleet.set_pose("uav1", pose(6.0, 20.0, 0.0))
    assert fleet.lag_s("uav1") == pytest.approx(2.0, abs=1e-3)
