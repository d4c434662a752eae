"""Routing problems as tensors: batched and padded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import torch
from torch import Tensor

from jfto_planner.policy.problems import GLOBAL_FEATURES, Problems, problems_of
from jfto_planner.routing.problem import RoutingProblem

__all__ = ["GLOBAL_FEATURES", "InstanceBatch", "from_problem", "stack", "symmetries", "turned"]


@dataclass(frozen=True)
class InstanceBatch:
    """The columns of Problems as tensors."""

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
        return self._each(lambda column: column.to(device))

    def rows(self, chosen: Tensor) -> InstanceBatch:
        """The problems that a mask or index chooses."""
        return self._each(lambda column: column[chosen])

    def numpy(self) -> Problems:
        """The same batch as arrays."""
        return Problems(**{f.name: getattr(self, f.name).cpu().numpy() for f in fields(self)})

    def global_features(self) -> Tensor:
        """What every node should know of the whole problem, (B, GLOBAL_FEATURES)."""
        return torch.from_numpy(self.numpy().global_features()).to(self.waypoints.device)

    def _each(self, change: Callable[[Tensor], Tensor]) -> InstanceBatch:
        return InstanceBatch(**{f.name: change(getattr(self, f.name)) for f in fields(self)})


def from_problem(problem: RoutingProblem) -> InstanceBatch:
    """One routing problem as a batch of one, float32."""
    return _tensors(problems_of(problem))


def symmetries(batch: InstanceBatch) -> InstanceBatch:
    """The eight reflections and rotations of every problem in the plane, as 8 B problems."""
    return _tensors(batch.numpy().symmetries())


def turned(batch: InstanceBatch, number: Tensor) -> InstanceBatch:
    """Each problem in one of its eight reflections and rotations, by number (B,), 0 to 7."""
    return _tensors(batch.numpy().turned(number.numpy()))


def stack(batches: list[InstanceBatch]) -> InstanceBatch:
    """Batches of any sizes as one, padded with absent waypoints, starts and UAVs."""
    widest = {
        "waypoints": max(batch.waypoints.shape[1] for batch in batches),
        "starts": max(batch.starts.shape[1] for batch in batches),
        "uavs": max(batch.start_of.shape[1] for batch in batches),
    }
    # A padded UAV must not divide by zero: its speeds are 1. Nor may it be the neighbour of one at
    # the same point: its reach is negative.
    fillers = {"speed": 1.0, "climb": 1.0, "descent": 1.0, "t_max": 1.0, "reach": -1.0}
    kinds = {"waypoints": "waypoints", "waypoint_valid": "waypoints", "starts": "starts"}
    columns: dict[str, Tensor] = {}
    for item in fields(InstanceBatch):
        parts = [getattr(batch, item.name) for batch in batches]
        if parts[0].ndim > 1:
            width = widest[kinds.get(item.name, "uavs")]
            parts = [_pad(part, width, fillers.get(item.name, 0.0)) for part in parts]
        columns[item.name] = torch.cat(parts)
    return InstanceBatch(**columns)


def _pad(tensor: Tensor, width: int, filler: float) -> Tensor:
    shape = list(tensor.shape)
    shape[1] = width - shape[1]
    return torch.cat([tensor, tensor.new_full(shape, filler)], dim=1)


def _tensors(problems: Problems) -> InstanceBatch:
    return InstanceBatch(
        **{f.name: torch.from_numpy(getattr(problems, f.name)) for f in fields(Problems)}
    )
