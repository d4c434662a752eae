"""Routing problems as the policy sees them: batched, padded and normalised."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from jfto_msgs_py.types import AnyArray
from jfto_planner.policy.features import (
    GLOBAL,
    TIME_SCALE,
    TOUR,
    UAVS_SCALE,
    WAYPOINTS_SCALE,
)
from jfto_planner.routing.problem import RoutingProblem
from jfto_world.kernel_struct import KernelStruct
from jfto_world.motion import ConstantSpeed, MotionLimits

if TYPE_CHECKING:
    import torch

SYMMETRIES = 8
# Where a drawn problem becomes one in metres and seconds.
MEAN_SPEED_MPS = 10.0
SLOTS = 150

Column = TypeVar("Column")


@dataclass(frozen=True, eq=False)
class Problems(KernelStruct, Generic[Column]):
    """B problems whose lengths are in units of the scene's extent and whose mean speed is 1.

    Columns are arrays for compiled code, or tensors to learn from. `waypoints` (B, W, 3) and
    `starts` (B, S, 3) are node coordinates, `start_of` (B, A) the start node of each UAV. `speed`,
    `climb`, `descent`, `t_max` and `reach` are (B, A), `k_min` (B,). `waypoint_valid` (B, W) and
    `uav_valid` (B, A) mark what is not padding; `extent_m` (B,) turns lengths back into metres.
    """

    waypoints: Column
    starts: Column
    start_of: Column
    speed: Column
    climb: Column
    descent: Column
    t_max: Column
    reach: Column
    k_min: Column
    waypoint_valid: Column
    uav_valid: Column
    extent_m: Column

    @property
    def size(self) -> int:
        """B, the number of problems."""
        columns: Any = self
        return int(columns.k_min.shape[0])

    def numpy(self) -> Problems[AnyArray]:
        """The same as arrays."""
        return self._each(
            lambda column: np.ascontiguousarray(
                column if isinstance(column, np.ndarray) else column.cpu().numpy()
            )
        )

    def tensors(self, device: torch.device | str = "cpu") -> Problems[torch.Tensor]:
        """The same as tensors on a device."""
        import torch

        return self._each(lambda column: torch.as_tensor(column).to(device))

    def rows(self, chosen: Column) -> Problems[Column]:
        """The problems that a mask or index chooses."""
        return self._each(lambda column: column[chosen])

    def _each(self, change: Callable[[Any], Any]) -> Problems[Any]:
        return Problems(**{item.name: change(getattr(self, item.name)) for item in fields(self)})


def global_features(problems: Problems[AnyArray]) -> AnyArray:
    """What every node should know of the whole problem, (B, GLOBAL_FEATURES): the scale of range
    and speed, the sizes and how tight the time is.
    """
    uavs = problems.uav_valid.sum(1).astype(np.float32)
    waypoints = problems.waypoint_valid.sum(1).astype(np.float32)

    def mean(value: AnyArray) -> AnyArray:
        return np.asarray((value * problems.uav_valid).sum(1) / uavs)

    expected = TOUR * np.sqrt(waypoints) / uavs
    columns = {
        "uavs": uavs / UAVS_SCALE,
        "waypoints": waypoints / WAYPOINTS_SCALE,
        "mean_reach": mean(problems.reach),
        "least_reach": np.where(problems.uav_valid, problems.reach, np.inf).min(1),
        "mean_time": mean(problems.t_max),
        "time_per_tour": mean(problems.t_max) / expected / TIME_SCALE,
        "k_min": problems.k_min / uavs,
        "climb": mean(problems.climb),
    }
    return np.stack([columns[name] for name in GLOBAL], axis=1).astype(np.float32)


def turned(problems: Problems[AnyArray], number: AnyArray) -> Problems[AnyArray]:
    """Each problem in one of its eight reflections and rotations, by number (B,), 0 to 7."""
    number = np.asarray(number)[:, None]
    moved = {}
    for name in ("waypoints", "starts"):
        x, y, z = np.moveaxis(getattr(problems, name), -1, 0)
        x = np.where(number % 2 == 1, 1 - x, x)
        y = np.where(number // 2 % 2 == 1, 1 - y, y)
        swap = number >= SYMMETRIES // 2
        moved[name] = np.stack((np.where(swap, y, x), np.where(swap, x, y), z), axis=-1)
    return replace(problems, **moved)


def symmetries(problems: Problems[AnyArray]) -> Problems[AnyArray]:
    """The eight reflections and rotations of every problem, as 8 B problems.

    Copy s of problem b is row s·B + b.
    """
    eight = problems.rows(np.tile(np.arange(problems.size), SYMMETRIES))
    return turned(eight, np.repeat(np.arange(SYMMETRIES), problems.size))


def problems_of(problem: RoutingProblem) -> Problems[AnyArray]:
    """One routing problem as a batch of one, float32."""
    points = np.concatenate([problem.waypoints_m, problem.starts_m])
    low = points.min(axis=0)
    extent = float(max(np.ptp(points[:, :2], axis=0).max(), 1.0))
    speeds = np.array([limit.speed_mps for limit in problem.limits])
    mean_speed = speeds.mean()
    starts, start_of = np.unique(problem.starts_m, axis=0, return_inverse=True)

    def row(values: AnyArray) -> AnyArray:
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


def problem_of(
    problems: Problems[Any], row: int, *, d_min_m: float = 5.0, slots: int = SLOTS
) -> RoutingProblem:
    """Routing problem of one row of an unpadded batch, with pads `d_min_m` × 1.5 apart.

    Energy is left out; the policy does not know it.
    """
    problems = problems.numpy()
    extent = float(problems.extent_m[row])

    def array(column: AnyArray) -> AnyArray:
        return column[row].astype(np.float64)

    start_of = problems.start_of[row]
    starts = array(problems.starts)[start_of] * extent
    # UAVs of one start point stand in a row, eastward.
    order = np.array([np.sum(start_of[:a] == start_of[a]) for a in range(len(start_of))])
    starts[:, 0] += order * d_min_m * 1.5
    speeds = zip(array(problems.speed), array(problems.climb), array(problems.descent), strict=True)
    return RoutingProblem(
        waypoints_m=array(problems.waypoints) * extent,
        starts_m=starts,
        limits=tuple(
            MotionLimits(*(float(value) * MEAN_SPEED_MPS for value in limits)) for limits in speeds
        ),
        time_model=ConstantSpeed(),
        t_max_s=array(problems.t_max) * extent / MEAN_SPEED_MPS,
        reach_m=array(problems.reach) * extent,
        k_min=int(problems.k_min[row]),
        d_min_m=0.0,
        length_max_m=1e7,
        slot_count=slots,
    )
