"""Paths, trajectories and poses through their messages."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.vehicle import TimedPath, TimedTrajectory, VehiclePose
from jfto_msgs_py.ros.vehicle import (
    decode_heading,
    decode_path,
    decode_pose,
    decode_trajectory,
    encode_heading,
    encode_path,
    encode_pose,
    encode_trajectory,
)

START_NS = 1763776800_250000001


@settings(deadline=None, max_examples=50)
@given(st.floats(-720, 720))
def test_headings_survive_the_quaternion(yaw_deg) -> None:
    """Clockwise from north to ENU quaternion and back, modulo a full turn."""
    back = decode_heading(encode_heading(yaw_deg))
    assert 0 <= back <= 360
    assert abs((back - yaw_deg + 180) % 360 - 180) < 1e-6


def test_heading_convention() -> None:
    """East is 90° in our records and the identity rotation in ENU (REP 103)."""
    quaternion = encode_heading(90.0)
    assert (quaternion.z, quaternion.w) == pytest.approx((0.0, 1.0))


def test_a_path_survives_its_message() -> None:
    """Points, headings and arrival stamps, to the nanosecond."""
    path = TimedPath(
        np.array([[0.0, 1.0, 2.0], [3.5, -4.0, 5.0]]),
        np.array([START_NS, START_NS + 12_345_678_901]),
        np.array([0.0, 270.0]),
    )
    back = decode_path(encode_path(path))
    assert np.array_equal(back.points_m, path.points_m)
    assert np.array_equal(back.arrival_ns, path.arrival_ns)
    np.testing.assert_allclose(back.yaw_deg, path.yaw_deg, atol=1e-6)


def test_a_trajectory_survives_its_message() -> None:
    """Position, velocity and acceleration with their times from start."""
    samples = np.arange(9, dtype=float).reshape(3, 3)
    given_ = TimedTrajectory(
        START_NS, np.array([0, 10**8, 2 * 10**9]), samples, samples * 2, samples * 3
    )
    message = encode_trajectory(given_, "uav7")
    back = decode_trajectory(message)
    assert message.joint_names == ["uav7"]
    assert back.start_ns == START_NS
    for name in ("offset_ns", "position_m", "velocity_mps", "acceleration_mps2"):
        assert np.array_equal(getattr(back, name), getattr(given_, name)), name


def _frame(message) -> None:
    message.header.frame_id = "odom"


def _nan(message) -> None:
    message.pose.position.x = float("nan")


def _null_rotation(message) -> None:
    message.pose.orientation.w = 0.0
    message.pose.orientation.z = 0.0


def _bad_stamp(message) -> None:
    message.header.stamp.nanosec = 2 * 10**9


@pytest.mark.parametrize(
    ("spoil", "field"),
    [
        (_frame, "header.frame_id"),
        (_nan, "pose.position"),
        (_null_rotation, "pose.orientation"),
        (_bad_stamp, "header.stamp"),
    ],
)
def test_a_malformed_pose_names_its_field(spoil, field) -> None:
    """Another frame, a number that is none, a null rotation and an impossible stamp."""
    message = encode_pose(VehiclePose(START_NS, (1.0, 2.0, 3.0), 45.0))
    spoil(message)
    with pytest.raises(MessageError) as caught:
        decode_pose(message)
    assert caught.value.field == field


def test_an_empty_path_and_trajectory_are_refused() -> None:
    """No points is no plan."""
    path = encode_path(TimedPath(np.zeros((1, 3)), np.array([0]), np.zeros(1)))
    path.poses = []
    with pytest.raises(MessageError, match=r"path\.poses"):
        decode_path(path)
    zeros = np.zeros((1, 3))
    message = encode_trajectory(TimedTrajectory(0, np.array([0]), zeros, zeros, zeros), "a")
    message.points[0].velocities = []
    with pytest.raises(MessageError, match=r"points\[0\]\.velocities"):
        decode_trajectory(message)
    message.points = []
    with pytest.raises(MessageError, match=r"trajectory\.points"):
        decode_trajectory(message)
