"""Routing problems as arrays, normalised: what the network sees, free of torch."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jfto_planner.policy.kernel.arrays import Scene
from jfto_planner.routing.problem import RoutingProblem

Array = NDArray[Any]
GLOBAL_FEATURES = 8
SYMMETRIES = 8


@dataclass(frozen=True)
class Problems:
    """B problems whose lengths are in units of the scene's extent and whose mean speed is 1.

    `waypoints` (B, W, 3) and `starts` (B, S, 3) are node coordinates, `start_of` (B, A) the start
    node of each UAV. `speed`, `climb`, `descent`, `t_max` and `reach` are (B, A), `k_min` (B,).
    `waypoint_valid` (B, W) and `uav_valid` (B, A) mark what is not padding; `extent_m` (B,) turns
    lengths back into metres.
    """

    waypoints: Array
    starts: Array
    start_of: Array
    speed: Array
    climb: Array
    descent: Array
    t_max: Array
    reach: Array
    k_min: Array
    waypoint_valid: Array
    uav_valid: Array
    extent_m: Array

    def global_features(self) -> Array:
        """What every node should know of the whole problem, (B, GLOBAL_FEATURES): the scale of
        range and speed, the sizes and how tight the time is.
        """
        uavs = self.uav_valid.sum(1).astype(np.float32)
        waypoints = self.waypoint_valid.sum(1).astype(np.float32)

        def mean(value: Array) -> Array:
            return np.asarray((value * self.uav_valid).sum(1) / uavs)

        least_reach = np.where(self.uav_valid, self.reach, np.inf).min(1)
        # Length of a short tour through W points of a unit square, per UAV (Beardwood et al.).
        expected = 0.7124 * np.sqrt(waypoints) / uavs
        columns = (
            uavs / 10,
            waypoints / 100,
            mean(self.reach),
            least_reach,
            mean(self.t_max),
            mean(self.t_max) / expected / 4,
            self.k_min / uavs,
            mean(self.climb),
        )
        return np.stack(columns, axis=1).astype(np.float32)

    def turned(self, number: Array) -> Problems:
        """Each problem in one of its eight reflections and rotations, by number (B,), 0 to 7."""
        number = np.asarray(number)[:, None]
        moved = {}
        for name in ("waypoints", "starts"):
            x, y, z = np.moveaxis(getattr(self, name), -1, 0)
            x = np.where(number % 2 == 1, 1 - x, x)
            y = np.where(number // 2 % 2 == 1, 1 - y, y)
            swap = number >= SYMMETRIES // 2
            moved[name] = np.stack((np.where(swap, y, x), np.where(swap, x, y), z), axis=-1)
        return replace(self, **moved)

    def symmetries(self) -> Problems:
        """The eight reflections and rotations of every problem, as 8 B problems.

        Copy s of problem b is row s·B + b.
        """
        size = len(self.k_min)
        columns = {
            item.name: np.concatenate([getattr(self, item.name)] * SYMMETRIES)
            for item in fields(Problems)
        }
        return Problems(**columns).turned(np.repeat(np.arange(SYMMETRIES), size))

    def scene(self) -> Scene:
        """The problems as the compiled kernels take them."""
        waypoints = np.ascontiguousarray(self.waypoints)
        square = ((waypoints[:, :, None] - waypoints[:, None]) ** 2).sum(-1)
        distance = np.sqrt(square)
        points = np.take_along_axis(self.starts, self.start_of[..., None], axis=1)
        return Scene(
            waypoints=waypoints,
            points=np.ascontiguousarray(points),
            start_of=np.ascontiguousarray(self.start_of),
            speed=np.ascontiguousarray(self.speed),
            climb=np.ascontiguousarray(self.climb),
            descent=np.ascontiguousarray(self.descent),
            t_max=np.ascontiguousarray(self.t_max),
            reach=np.ascontiguousarray(self.reach),
            k_min=np.ascontiguousarray(self.k_min),
            waypoint_valid=np.ascontiguousarray(self.waypoint_valid),
            uav_valid=np.ascontiguousarray(self.uav_valid),
            distance=distance,
            # Not a stable sort, which is slower: the kernels read no more than distances from it.
            nearest=np.argsort(distance, axis=-1).astype(np.int32),
            starts=self.starts.shape[1],
        )


def problems_of(problem: RoutingProblem) -> Problems:
    """One routing problem as a batch of one, float32."""
    points = np.concatenate([problem.waypoints_m, problem.starts_m])
    low = points.min(axis=0)
    extent = float(max(np.ptp(points[:, :2], axis=0).max(), 1.0))
    speeds = np.array([limit.speed_mps for limit in problem.limits])
    mean_speed = speeds.mean()
    starts, start_of = np.unique(problem.starts_m, axis=0, return_inverse=True)

    def row(values: Array) -> Array:
        return np.asarray(values, dtype=np.float32)[None]

    return Problems(
        waypoints=row((problem.waypoints_m - low) / extent),
        starts=row((starts - low) / extent),
        start_of=start_of.reshape(1, -1).astype(np.int64),
        speed=row(speeds / mean_speed),
        climb=row(np.array([limit.climb_mps for limit in problem.limits]) / mean_speed),
        descent=row(np.array([limit.descent_mps for limit in problem.limits]) / mean_speed),
        t_max=row(problem.latest_arrival_s * mean_speed / extent),
        reach=row(problem.reach_m / extent),
        k_min=np.array([problem.k_min]),
        waypoint_valid=np.ones((1, problem.waypoint_count), dtype=bool),
        uav_valid=np.ones((1, problem.uav_count), dtype=bool),
        extent_m=np.array([extent]),
    )
