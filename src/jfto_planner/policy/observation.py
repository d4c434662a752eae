"""What choices are based on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from jfto_msgs_py.types import AnyArray
from jfto_planner.policy.features import PAIR_FEATURES, STATE_FEATURES
from jfto_planner.policy.problems import Problems
from jfto_world.kernel_struct import KernelStruct

if TYPE_CHECKING:
    import torch

Column = TypeVar("Column")


@dataclass(frozen=True, eq=False)
class Observation(KernelStruct, Generic[Column]):
    """What the choices of B problems × P rollouts × T steps are based on.

    Columns are arrays (B, P, T, …) of compiled rollouts, or tensors (B, P, …) of one step, or
    (B, P · T, …) of all. `active` is the UAV that chooses and `now` when. `allowed` (…, W + 1)
    marks its choices, the last being to stop, and `keeps_rule` those that leave every UAV its K_min
    neighbours. `visited` (…, W) marks waypoints that are taken, or padding, and `duration` is that
    of the legs to the others. `node` (…, A) is the node each UAV flies to (starts first, then
    waypoints). `state` (…, STATE_FEATURES) holds the paper's T and K, `pair`
    (…, W, PAIR_FEATURES) what relates the UAV to each waypoint.
    """

    active: Column
    now: Column
    allowed: Column
    keeps_rule: Column
    visited: Column
    duration: Column
    node: Column
    state: Column
    pair: Column

    def tensors(self) -> Observation[torch.Tensor]:
        """All steps of arrays as tensors of P · T rollouts, the steps of one side by side."""
        import torch

        return self._each(lambda column: torch.from_numpy(column).flatten(1, 2))

    def to(self, device: torch.device | str) -> Observation[torch.Tensor]:
        """The same tensors on a device."""
        return self._each(lambda column: column.to(device))

    def _each(self, change: Callable[[Any], Any]) -> Observation[Any]:
        return Observation(**{item.name: change(getattr(self, item.name)) for item in fields(self)})


def room_for(problems: Problems[AnyArray], rollouts: int, steps: int) -> Observation[AnyArray]:
    """Arrays for the observations of so many steps."""
    count, uavs = problems.speed.shape
    waypoints = problems.waypoints.shape[1]
    shape = (count, rollouts, steps)
    return Observation(
        active=np.zeros(shape, np.int64),
        now=np.zeros(shape, np.float32),
        allowed=np.zeros((*shape, waypoints + 1), np.bool_),
        keeps_rule=np.zeros((*shape, waypoints + 1), np.bool_),
        visited=np.zeros((*shape, waypoints), np.bool_),
        duration=np.zeros((*shape, waypoints), np.float32),
        node=np.zeros((*shape, uavs), np.int64),
        state=np.zeros((*shape, STATE_FEATURES), np.float32),
        pair=np.zeros((*shape, waypoints, PAIR_FEATURES), np.float32),
    )


def joined(steps: list[Observation[torch.Tensor]]) -> Observation[torch.Tensor]:
    """Observations of T steps as those of P · T rollouts, the steps of one side by side."""
    import torch

    columns = {
        item.name: torch.stack([getattr(step, item.name) for step in steps], 2).flatten(1, 2)
        for item in fields(Observation)
    }
    return Observation(**columns)
