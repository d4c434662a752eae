"""Routing problems as tensors: normalised, batched and padded."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import torch
from torch import Tensor

from jfto_planner.routing.problem import RoutingProblem

GLOBAL_FEATURES = 8


@dataclass(frozen=True)
class InstanceBatch:
    """B problems whose lengths are in units of the scene's extent and whose mean speed is 1.

    `waypoints` (B, W, 3) and `starts` (B, S, 3) are node coordinates, `start_of` (B, A) the start
    node of each UAV. `speed`, `climb`, `descent`, `t_max` and `reach` are (B, A), `k_min` (B,).
    `waypoint_valid` (B, W) and `uav_valid` (B, A) mark what is not padding; `extent_m` (B,) turns
    lengths back into metres.
    """

    waypoints: Tensor
    starts: Tensor
    start_of: Tensor
    speed: Tensor
    climb: Tensor
    descent: Tensor
    t_max: Tensor
    reach: Tensor
    k_min: Tensor
    waypoint_valid: Tensor
    uav_valid: Tensor
    extent_m: Tensor

    @property
    def size(self) -> int:
        """B, the number of problems."""
        return self.waypoints.shape[0]

    @property
    def pair_reach(self) -> Tensor:
        """Greatest link distance of each pair (B, A, A): the lesser of both ranges."""
        return torch.minimum(self.reach[:, :, None], self.reach[:, None, :])

    @property
    def start_points(self) -> Tensor:
        """Where each UAV starts (B, A, 3)."""
        return self.starts.gather(1, self.start_of[..., None].expand(-1, -1, 3))

    def to(self, device: torch.device | str) -> InstanceBatch:
        """The same batch on a device."""
        moved = {item.name: getattr(self, item.name).to(device) for item in fields(self)}
        return InstanceBatch(**moved)

    def global_features(self) -> Tensor:
        """What every node should know of the whole problem, (B, GLOBAL_FEATURES): the scale of
        range and speed, the sizes and how tight the time is.
        """
        uavs = self.uav_valid.sum(1).float()
        waypoints = self.waypoint_valid.sum(1).float()

        def mean(value: Tensor) -> Tensor:
            return (value * self.uav_valid).sum(1) / uavs

        least_reach = torch.where(self.uav_valid, self.reach, torch.inf).amin(1)
        # Length of a short tour through W points of a unit square, per UAV (Beardwood et al.).
        expected = 0.7124 * waypoints.sqrt() / uavs
        columns = (
            uavs / 10,
            waypoints / 100,
            mean(self.reach),
            least_reach,
            mean(self.t_max),
            mean(self.t_max) / expected / 4,
            self.k_min.float() / uavs,
            mean(self.climb),
        )
        return torch.stack(columns, dim=1)


def from_problem(problem: RoutingProblem) -> InstanceBatch:
    """One routing problem as a batch of one, float32."""
    points = np.concatenate([problem.waypoints_m, problem.starts_m])
    low = points.min(axis=0)
    extent = float(max(np.ptp(points[:, :2], axis=0).max(), 1.0))
    speeds = np.array([limit.speed_mps for limit in problem.limits])
    mean_speed = speeds.mean()
    starts, start_of = np.unique(problem.starts_m, axis=0, return_inverse=True)

    def vector(values: np.ndarray) -> Tensor:
        return torch.as_tensor(np.asarray(values, dtype=np.float32))[None]

    return InstanceBatch(
        waypoints=vector((problem.waypoints_m - low) / extent),
        starts=vector((starts - low) / extent),
        start_of=torch.as_tensor(start_of.reshape(-1))[None],
        speed=vector(speeds / mean_speed),
        climb=vector(np.array([limit.climb_mps for limit in problem.limits]) / mean_speed),
        descent=vector(np.array([limit.descent_mps for limit in problem.limits]) / mean_speed),
        t_max=vector(problem.latest_arrival_s * mean_speed / extent),
        reach=vector(problem.reach_m / extent),
        k_min=torch.tensor([problem.k_min]),
        waypoint_valid=torch.ones(1, problem.waypoint_count, dtype=torch.bool),
        uav_valid=torch.ones(1, problem.uav_count, dtype=torch.bool),
        extent_m=torch.tensor([extent], dtype=torch.float64),
    )


def stack(batches: list[InstanceBatch]) -> InstanceBatch:
    """Batches of any sizes as one, padded with absent waypoints, starts and UAVs."""
    widest = {
        "waypoints": max(batch.waypoints.shape[1] for batch in batches),
        "starts": max(batch.starts.shape[1] for batch in batches),
        "uavs": max(batch.start_of.shape[1] for batch in batches),
    }
    columns: dict[str, Tensor] = {}
    for item in fields(InstanceBatch):
        parts = [getattr(batch, item.name) for batch in batches]
        if parts[0].ndim > 1:
            kind = {"waypoints": "waypoints", "waypoint_valid": "waypoints", "starts": "starts"}
            width = widest[kind.get(item.name, "uavs")]
            # A padded UAV must not divide by zero: its speeds are 1.
            filler = 1.0 if item.name in ("speed", "climb", "descent", "t_max") else 0
            parts = [_pad(part, width, filler) for part in parts]
        columns[item.name] = torch.cat(parts)
    return InstanceBatch(**columns)


def _pad(tensor: Tensor, width: int, filler: float) -> Tensor:
    shape = list(tensor.shape)
    shape[1] = width - shape[1]
    return torch.cat([tensor, tensor.new_full(shape, filler)], dim=1)


def symmetries(batch: InstanceBatch) -> InstanceBatch:
    """The eight reflections and rotations of every problem in the plane, as 8 B problems.

    Copy s of problem b is row s·B + b.
    """
    copies = []
    for swap in (False, True):
        for mirror_x in (False, True):
            for mirror_y in (False, True):
                moved = {}
                for name in ("waypoints", "starts"):
                    x, y, z = getattr(batch, name).unbind(-1)
                    x = 1 - x if mirror_x else x
                    y = 1 - y if mirror_y else y
                    moved[name] = torch.stack((y, x, z) if swap else (x, y, z), dim=-1)
                copies.append(replace(batch, **moved))
    columns = {
        item.name: torch.cat([getattr(copy, item.name) for copy in copies])
        for item in fields(InstanceBatch)
    }
    return InstanceBatch(**columns)
