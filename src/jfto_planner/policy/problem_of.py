"""A drawn instance as a routing problem in metres and seconds."""

from __future__ import annotations

import numpy as np
from torch import Tensor

from jfto_planner.policy.instance import InstanceBatch
from jfto_planner.routing.problem import RoutingProblem
from jfto_world.motion import ConstantSpeed, MotionLimits

MEAN_SPEED_MPS = 10.0
SLOTS = 150


def problem_of(
    batch: InstanceBatch, row: int, *, d_min_m: float = 5.0, slots: int = SLOTS
) -> RoutingProblem:
    """Routing problem of one row of an unpadded batch, with pads `d_min_m` × 1.5 apart.

    Energy is left out; the policy does not know it.
    """
    extent = float(batch.extent_m[row])

    def array(tensor: Tensor) -> np.ndarray:
        return tensor[row].numpy().astype(np.float64)

    starts = array(batch.starts)[batch.start_of[row].numpy()] * extent
    # UAVs of one start point stand in a row, eastward.
    order = np.zeros(len(starts))
    for point in set(batch.start_of[row].tolist()):
        here = batch.start_of[row].numpy() == point
        order[here] = np.arange(here.sum())
    starts[:, 0] += order * d_min_m * 1.5
    speeds = zip(array(batch.speed), array(batch.climb), array(batch.descent), strict=True)
    return RoutingProblem(
        waypoints_m=array(batch.waypoints) * extent,
        starts_m=starts,
        limits=tuple(
            MotionLimits(*(float(value) * MEAN_SPEED_MPS for value in limits)) for limits in speeds
        ),
        time_model=ConstantSpeed(),
        t_max_s=array(batch.t_max) * extent / MEAN_SPEED_MPS,
        reach_m=array(batch.reach) * extent,
        k_min=int(batch.k_min[row]),
        d_min_m=0.0,
        length_max_m=1e7,
        slot_count=slots,
    )
