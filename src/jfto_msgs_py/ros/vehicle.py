"""Paths, trajectories and poses as stock messages."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.vehicle import TimedPath, TimedTrajectory, VehiclePose
from jfto_msgs_py.ros.stamps import decode_duration, decode_time, encode_duration, encode_time
from jfto_msgs_py.ros.topics import MAP_FRAME


def encode_path(path: TimedPath) -> Any:
    """nav_msgs/Path whose pose stamps are planned arrival times."""
    from nav_msgs.msg import Path

    message = Path()
    message.header.frame_id = MAP_FRAME
    message.header.stamp = encode_time(int(path.arrival_ns[0]))
    message.poses = [
        encode_pose(
            VehiclePose(int(stamp), (float(point[0]), float(point[1]), float(point[2])), float(yaw))
        )
        for stamp, point, yaw in zip(path.arrival_ns, path.points_m, path.yaw_deg, strict=True)
    ]
    return message


def decode_path(message: Any) -> TimedPath:
    """Path in a nav_msgs/Path. Raises MessageError naming the field at fault."""
    _check_frame(message.header.frame_id)
    poses = [decode_pose(pose) for pose in message.poses]
    return TimedPath(
        np.array([pose.position_m for pose in poses], dtype=np.float64).reshape(-1, 3),
        np.array([pose.stamp_ns for pose in poses], dtype=np.int64),
        np.array([pose.yaw_deg for pose in poses], dtype=np.float64),
    )


def encode_pose(pose: VehiclePose) -> Any:
    """geometry_msgs/PoseStamped in the map frame."""
    from geometry_msgs.msg import Point, PoseStamped

    message = PoseStamped()
    message.header.frame_id = MAP_FRAME
    message.header.stamp = encode_time(pose.stamp_ns)
    x, y, z = pose.position_m
    message.pose.position = Point(x=x, y=y, z=z)
    message.pose.orientation = encode_heading(pose.yaw_deg)
    return message


def decode_pose(message: Any) -> VehiclePose:
    """Pose in a geometry_msgs/PoseStamped. Raises MessageError naming the field at fault."""
    _check_frame(message.header.frame_id)
    point = message.pose.position
    return VehiclePose(
        decode_time(message.header.stamp),
        (point.x, point.y, point.z),
        decode_heading(message.pose.orientation),
    )


def encode_trajectory(trajectory: TimedTrajectory, uav_id: str) -> Any:
    """trajectory_msgs/MultiDOFJointTrajectory with one joint, named after the UAV."""
    from trajectory_msgs.msg import MultiDOFJointTrajectory

    message = MultiDOFJointTrajectory()
    message.header.frame_id = MAP_FRAME
    message.header.stamp = encode_time(trajectory.start_ns)
    message.joint_names = [uav_id]
    message.points = [
        _trajectory_point(
            int(trajectory.offset_ns[index]),
            trajectory.position_m[index].tolist(),
            trajectory.velocity_mps[index].tolist(),
            trajectory.acceleration_mps2[index].tolist(),
        )
        for index in range(len(trajectory.offset_ns))
    ]
    return message


def _trajectory_point(
    offset_ns: int, position: list[float], velocity: list[float], acceleration: list[float]
) -> Any:
    from geometry_msgs.msg import Transform, Twist, Vector3
    from trajectory_msgs.msg import MultiDOFJointTrajectoryPoint

    return MultiDOFJointTrajectoryPoint(
        transforms=[Transform(translation=_vector(Vector3, position))],
        velocities=[Twist(linear=_vector(Vector3, velocity))],
        accelerations=[Twist(linear=_vector(Vector3, acceleration))],
        time_from_start=encode_duration(offset_ns),
    )


def decode_trajectory(message: Any) -> TimedTrajectory:
    """Trajectory of the one joint of a message. Raises MessageError naming the field at fault."""
    _check_frame(message.header.frame_id)
    for index, point in enumerate(message.points):
        for name in ("transforms", "velocities", "accelerations"):
            if len(getattr(point, name)) != 1:
                raise MessageError(
                    f"points[{index}].{name}", f"has {len(getattr(point, name))} entries, not 1"
                )
    return TimedTrajectory(
        decode_time(message.header.stamp),
        np.array(
            [
                decode_duration(point.time_from_start, f"points[{index}].time_from_start")
                for index, point in enumerate(message.points)
            ],
            dtype=np.int64,
        ),
        _stack([point.transforms[0].translation for point in message.points]),
        _stack([point.velocities[0].linear for point in message.points]),
        _stack([point.accelerations[0].linear for point in message.points]),
    )


def _vector(kind: Any, values: list[float]) -> Any:
    return kind(x=values[0], y=values[1], z=values[2])


def _stack(vectors: list[Any]) -> NDArray[np.float64]:
    rows = [(vector.x, vector.y, vector.z) for vector in vectors]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def _check_frame(frame_id: str) -> None:
    if frame_id != MAP_FRAME:
        raise MessageError("header.frame_id", f"is {frame_id!r}, expected {MAP_FRAME!r}")


def encode_heading(yaw_deg: float) -> Any:
    """geometry_msgs/Quaternion in ENU of a heading clockwise from north (REP 103)."""
    from geometry_msgs.msg import Quaternion

    half = math.radians(90.0 - yaw_deg) / 2
    return Quaternion(x=0.0, y=0.0, z=math.sin(half), w=math.cos(half))


def decode_heading(quaternion: Any, field: str = "pose.orientation") -> float:
    """Heading in degrees clockwise from north, in [0, 360). Raises MessageError for a null one."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    norm = x * x + y * y + z * z + w * w
    if not (math.isfinite(norm) and abs(norm - 1.0) < 1e-3):
        raise MessageError(field, f"has norm² {norm}, expected 1")
    yaw_enu = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return (90.0 - math.degrees(yaw_enu)) % 360.0
