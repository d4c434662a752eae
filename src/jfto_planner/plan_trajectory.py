"""A plan as what each UAV is told to fly: paths and trajectories in absolute time."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import TimedPath, TimedTrajectory
from jfto_msgs_py.types import Array, Ints
from jfto_planner.smoothing.trajectory import Trajectory
from jfto_world.motion import ConstantSpeed, MotionLimits, time_model_named
from jfto_world.motion.lines import along

# Between waypoints, where a UAV does not fly straight at constant speed.
SAMPLE_S = 0.5


def timed_paths(plan: Plan, start_ns: int) -> dict[str, TimedPath]:
    """Pad and waypoints of each UAV with arrival times; `start_ns` is lift-off.

    At the pad a UAV looks where it will at its first waypoint.
    """
    waypoints = {waypoint.id: waypoint for waypoint in plan.waypoints}
    paths = {}
    for uav, route in zip(plan.uavs, plan.routes, strict=True):
        visited = [waypoints[number] for number in route.waypoint_ids]
        yaw_deg = [waypoint.yaw_deg for waypoint in visited]
        paths[uav.id] = TimedPath(
            np.array([uav.start_m, *(waypoint.position_m for waypoint in visited)]),
            start_ns + _nanoseconds(np.array([0.0, *route.arrival_s])),
            np.array([yaw_deg[0] if yaw_deg else 0.0, *yaw_deg]),
        )
    return paths


def timed_trajectories(plan: Plan, start_ns: int) -> dict[str, TimedTrajectory]:
    """Trajectory of each UAV, the smoothed one where the plan has it; `start_ns` is lift-off.

    Positions between samples are meant as straight. Raises InputError for an unknown time model
    or kind of trajectory.
    """
    found = {}
    for index, uav in enumerate(plan.uavs):
        if plan.trajectories:
            offsets_ns, parts = _smooth(Trajectory.from_record(plan.trajectories[index]))
        else:
            offsets_ns, parts = _straight(plan, index)
        found[uav.id] = TimedTrajectory(start_ns, offsets_ns, *parts)
    return found


def _smooth(curve: Trajectory) -> tuple[Ints, tuple[Array, Array, Array]]:
    times = np.concatenate([[0.0], curve.knots_s, np.arange(0.0, curve.end_s, SAMPLE_S)])
    offsets_ns = np.unique(_nanoseconds(times))
    motion = curve.motion(offsets_ns / 1e9)
    return offsets_ns, (motion.position_m, motion.velocity_mps, motion.acceleration_mps2)


def _straight(plan: Plan, index: int) -> tuple[Ints, tuple[Array, Array, Array]]:
    uav, route = plan.uavs[index], plan.routes[index]
    position_of = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
    line = np.array([uav.start_m, *(position_of[number] for number in route.waypoint_ids)])
    arrival_s = np.array([0.0, *route.arrival_s])
    model = time_model_named(plan.time_model, plan.time_parameters)
    if isinstance(model, ConstantSpeed):
        offsets_ns, kept = np.unique(_nanoseconds(arrival_s), return_index=True)
        position = line[kept]
    else:
        times = np.concatenate([arrival_s, np.arange(0.0, arrival_s[-1], SAMPLE_S)])
        offsets_ns = np.unique(_nanoseconds(times))
        limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
        flight = along(model, route.lines)
        position = flight.positions(line, limits, offsets_ns / 1e9)
    velocity = np.zeros_like(position)
    velocity[:-1] = np.diff(position, axis=0) / (np.diff(offsets_ns) / 1e9)[:, None]
    return offsets_ns, (position, velocity, np.zeros_like(position))


def _nanoseconds(seconds: Array) -> Ints:
    return np.rint(seconds * 1e9).astype(np.int64)
