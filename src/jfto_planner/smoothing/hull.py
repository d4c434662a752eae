"""Proof that a trajectory keeps its limits everywhere, not only at samples."""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.types import Array
from jfto_planner.smoothing.limits import GRAVITY_MPS2, CurveLimits
from jfto_planner.smoothing.trajectory import Trajectory


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
