"""What trajectories ask of a vehicle and how near they come to things, measured from outside."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jfto_msgs_py.types import Array
from jfto_msgs_py.units import GRAVITY_MPS2
from jfto_planner.smoothing import CurveLimits, Motion, Trajectory
from jfto_planner.smoothing.separation import closest
from jfto_world.motion import ConstantSpeed, MotionLimits


def sampled(trajectory: Trajectory, per_segment: int) -> Motion:
    """Motion at `per_segment` + 1 even instants of each segment, ends included, S · (n + 1) in all.

    Both ends of a segment are evaluated on that segment.
    """
    motions = []
    for control_m, span_s in zip(trajectory.control_m, trajectory.duration_s, strict=True):
        alone = replace(
            trajectory, control_m=control_m[None], duration_s=np.array([span_s]), delay_s=0.0
        )
        motions.append(alone.motion(np.linspace(0.0, span_s, per_segment + 1)))
    return Motion(
        *(
            np.concatenate([getattr(motion, name) for motion in motions])
            for name in ("position_m", "velocity_mps", "acceleration_mps2", "jerk_mps3")
        )
    )


def ratios_at_samples(
    trajectory: Trajectory, limits: CurveLimits, per_segment: int = 1000
) -> dict[str, float]:
    """Greatest of each quantity over its limit, at samples; keys as in `limit_ratios`."""
    m = sampled(trajectory, per_segment)
    push = m.acceleration_mps2 + limits.drag_1ps * m.velocity_mps + np.array([0, 0, GRAVITY_MPS2])
    tilt = np.degrees(np.arctan2(np.hypot(push[:, 0], push[:, 1]), push[:, 2]))
    return {
        "speed": np.hypot(*m.velocity_mps[:, :2].T).max() / limits.speed_mps,
        "climb": m.velocity_mps[:, 2].max() / limits.climb_mps,
        "descent": -m.velocity_mps[:, 2].min() / limits.descent_mps,
        "acceleration": np.hypot(*m.acceleration_mps2[:, :2].T).max() / limits.accel_mps2,
        "acceleration_z": np.abs(m.acceleration_mps2[:, 2]).max() / limits.accel_z_mps2,
        "jerk": np.linalg.norm(m.jerk_mps3, axis=1).max() / limits.jerk_mps3,
        "tilt": tilt.max() / limits.tilt_deg,
    }


def worst_jump(trajectory: Trajectory, limits: CurveLimits, extent_m: float) -> float:
    """Largest jump of position, velocity or acceleration at a joint, relative to its scale."""
    m = sampled(trajectory, 1)
    scales = (extent_m, limits.speed_mps, limits.accel_mps2)
    parts = (m.position_m, m.velocity_mps, m.acceleration_mps2)
    ends = [part.reshape(-1, 2, 3) / scale for part, scale in zip(parts, scales, strict=True)]
    return max(float(np.abs(e[1:, 0] - e[:-1, 1]).max(initial=0.0)) for e in ends)


def limit_ratios(
    trajectory: Trajectory, limits: CurveLimits, halvings: int = 4
) -> dict[str, float]:
    """Upper bound of each quantity over its limit, whole trajectory; <= 1 proves that it is kept.

    A Bezier curve lies inside the hull of its control points. Each segment is cut in half
    `halvings` times (de Casteljau), which brings the hull close to the curve: the bound exceeds
    the true peak by about 4^-halvings. Acceleration is raised by one degree, so that it shares
    its parameter with velocity in the tilt cone. Keys: speed, climb, descent, acceleration,
    acceleration_z, jerk, tilt.
    """
    points, span = trajectory.control_m, trajectory.duration_s
    for _ in range(halvings):
        points, span = _halved(points), np.repeat(span / 2.0, 2)
    scale = span[:, None, None]
    velocity = 5.0 * np.diff(points, axis=1) / scale
    accel = 4.0 * np.diff(velocity, axis=1) / scale
    jerk = 3.0 * np.diff(accel, axis=1) / scale
    share = np.arange(5)[:, None] / 4.0
    padded = np.pad(accel, ((0, 0), (1, 1), (0, 0)))
    raised = share * padded[:, :5] + (1.0 - share) * padded[:, 1:]
    push = raised + limits.drag_1ps * velocity
    push[..., 2] += GRAVITY_MPS2
    tilt = np.hypot(push[..., 0], push[..., 1]) / np.maximum(push[..., 2], 1e-9)
    return {
        "speed": float(np.hypot(velocity[..., 0], velocity[..., 1]).max() / limits.speed_mps),
        "climb": float(velocity[..., 2].max() / limits.climb_mps),
        "descent": float(-velocity[..., 2].min() / limits.descent_mps),
        "acceleration": float(np.hypot(accel[..., 0], accel[..., 1]).max() / limits.accel_mps2),
        "acceleration_z": float(np.abs(accel[..., 2]).max() / limits.accel_z_mps2),
        "jerk": float(np.linalg.norm(jerk, axis=-1).max() / limits.jerk_mps3),
        "tilt": float(tilt.max() / math.tan(math.radians(limits.tilt_deg))),
    }


def _halved(points: Array) -> Array:
    """Control points (2 S, n, 3) of both halves of each segment (S, n, 3), in order."""
    left, right = [points[:, 0]], [points[:, -1]]
    while points.shape[1] > 1:
        points = 0.5 * (points[:, :-1] + points[:, 1:])
        left.append(points[:, 0])
        right.append(points[:, -1])
    both = np.stack([np.stack(left, axis=1), np.stack(right[::-1], axis=1)], axis=1)
    return both.reshape(-1, *both.shape[2:])


def straight_line_s(points_m: Array, limits: CurveLimits) -> float:
    """Lower bound of any trajectory through the points: straight legs at full speed."""
    speeds = MotionLimits(limits.speed_mps, limits.climb_mps, limits.descent_mps)
    return float(ConstantSpeed().arrivals(points_m, speeds)[-1])


def closest_approach_m(trajectories: Sequence[Trajectory], check_s: float = 0.1) -> float:
    """Least distance of any two trajectories in continuous time; inf for fewer than two."""
    pairs = [(a, b) for k, b in enumerate(trajectories) for a in trajectories[:k]]
    return min((closest(a, b, check_s)[1] for a, b in pairs), default=math.inf)


def least_clearance_m(
    trajectory: Trajectory, ground_height: Callable[[Array, Array], Array], step_s: float = 0.01
) -> float:
    """Smallest height above ground along a trajectory, from its start to its end."""
    places = trajectory.positions(np.arange(0.0, trajectory.end_s + step_s, step_s))
    return float(np.min(places[:, 2] - ground_height(places[:, 0], places[:, 1])))
