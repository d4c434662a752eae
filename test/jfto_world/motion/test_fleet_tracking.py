"""What a fleet's records are taken for: its plan, its poses, and its clock."""

from __future__ import annotations

from dataclasses import replace

import pytest

from jfto_msgs_py.errors import MessageError
from jfto_world.motion.fleet_tracking import AHEAD_SIMULATED_S, FleetTracking
from support.fleets import START_NS, at, eastward, pose

IDS = ("uav1", "uav2")


def test_a_fleet_has_a_plan_once_all_trajectories_begin_together() -> None:
    """One of an older planning is missing like one that never came; the same again is none."""
    tracking = FleetTracking(IDS)
    assert tracking.missing == IDS
    assert tracking.take_trajectory("uav1", eastward(0.0))
    assert tracking.missing == ("uav2",)
    assert tracking.take_trajectory("uav2", eastward(100.0))
    assert tracking.complete
    assert tracking.duration_s == 20.0
    assert not tracking.take_trajectory("uav2", eastward(100.0))
    later = replace(eastward(100.0), start_ns=START_NS + 10**9)
    assert tracking.take_trajectory("uav2", later)
    assert tracking.missing == ("uav1",)


@pytest.mark.parametrize(("ahead_s", "limit_s"), [(1.0, 1.0), (AHEAD_SIMULATED_S, 10.0)])
def test_a_pose_from_the_future_is_refused(ahead_s, limit_s) -> None:
    """It would hide all that come after it; before the clock has begun there is no telling."""
    tracking = FleetTracking(IDS, ahead_s)
    tracking.take_trajectory("uav1", eastward(0.0))
    tracking.take_pose("uav1", pose(limit_s, 0.0, 0.0), at(0.0))
    with pytest.raises(MessageError, match=r"header\.stamp: is .* s ahead of this clock"):
        tracking.take_pose("uav1", pose(limit_s + 0.1, 0.0, 0.0), at(0.0))
    assert tracking.prediction.pose_stamp_ns("uav1") == at(limit_s)
    tracking.take_pose("uav1", pose(limit_s + 0.1, 0.0, 0.0), 0)
    assert tracking.prediction.pose_stamp_ns("uav1") == at(limit_s + 0.1)


def test_poses_of_a_clock_that_was_set_back_are_forgotten() -> None:
    """By more than a second: those after it count again, though their stamps are older."""
    tracking = FleetTracking(IDS)
    tracking.take_trajectory("uav1", eastward(0.0))
    assert tracking.follow_clock(at(10.0)) == 0
    tracking.take_pose("uav1", pose(10.0, 50.0, 0.0), at(10.0))
    assert tracking.follow_clock(at(9.5)) == 0
    assert tracking.prediction.pose_stamp_ns("uav1") == at(10.0)
    assert tracking.follow_clock(at(4.0)) == 5_500_000_000
    assert tracking.prediction.pose_stamp_ns("uav1") is None
    tracking.take_pose("uav1", pose(4.0, 20.0, 0.0), at(4.0))
    assert tracking.prediction.pose_stamp_ns("uav1") == at(4.0)
