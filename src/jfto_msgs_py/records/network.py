"""What the topology and power nodes say about a stretch of slots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.types import AnyArray, Array

LEAST_SLOT_S = 1e-6
# Times are nanoseconds in 64 bits; builtin_interfaces/Time ends in 2038 anyway.
LATEST_NS = 2**62


@dataclass(frozen=True)
class SlotHorizon:
    """`count` consecutive slots from slot `first`, which begins at `t0_ns` (ns since the epoch).

    Each lasts `duration_s`. Raises MessageError for an empty or backward horizon.
    """

    first: int
    t0_ns: int
    duration_s: float
    count: int

    def __post_init__(self) -> None:
        if self.first < 0:
            raise MessageError("slot.first", f"is {self.first}, must be 0 or more")
        if self.t0_ns < 0:
            raise MessageError("slot.t0", f"is {self.t0_ns} ns, must be 0 or more")
        if not LEAST_SLOT_S <= self.duration_s < np.inf:
            raise MessageError(
                "slot.dt", f"is {self.duration_s} s, must be {LEAST_SLOT_S} s or more"
            )
        if self.count < 1:
            raise MessageError("slot.count", f"is {self.count}, must be at least 1")
        if self.t0_ns + self.count * self.duration_s * 1e9 >= LATEST_NS:
            raise MessageError("slot.t0", "the horizon ends beyond what a time can hold")

    @property
    def instants_ns(self) -> NDArray[np.int64]:
        """Beginning of each slot in ns since the epoch, shape (count,)."""
        step_ns = np.rint(np.arange(self.count) * self.duration_s * 1e9).astype(np.int64)
        return self.t0_ns + step_ns


@dataclass(frozen=True, eq=False)
class Adjacency:
    """Active links per slot: `links` is (slot, uav, uav), bool, symmetric, diagonal False."""

    horizon: SlotHorizon
    uav_ids: tuple[str, ...]
    links: NDArray[np.bool_]

    def __post_init__(self) -> None:
        _check_ids(self.uav_ids)
        fleet = len(self.uav_ids)
        _check_shape("adjacency", self.links, (self.horizon.count, fleet, fleet))
        if not np.array_equal(self.links, np.swapaxes(self.links, 1, 2)):
            raise MessageError("adjacency.data", "is not symmetric")
        if self.links[:, np.arange(fleet), np.arange(fleet)].any():
            raise MessageError("adjacency.data", "links a UAV to itself")


@dataclass(frozen=True, eq=False)
class PowerIntervals:
    """Allowed transmit powers in W: `bounds_w` is (slot, uav, 2), min then max."""

    horizon: SlotHorizon
    uav_ids: tuple[str, ...]
    bounds_w: Array

    def __post_init__(self) -> None:
        _check_ids(self.uav_ids)
        _check_shape("power_interval", self.bounds_w, (self.horizon.count, len(self.uav_ids), 2))
        _check_powers("power_interval.data", self.bounds_w)
        if (self.bounds_w[..., 0] > self.bounds_w[..., 1]).any():
            slot, uav = np.argwhere(self.bounds_w[..., 0] > self.bounds_w[..., 1])[0]
            raise MessageError(
                "power_interval.data",
                f"min exceeds max for {self.uav_ids[uav]} in slot {self.horizon.first + slot}",
            )


@dataclass(frozen=True, eq=False)
class PowerSchedule:
    """Transmit powers in W: `power_w` is (slot, uav)."""

    horizon: SlotHorizon
    uav_ids: tuple[str, ...]
    power_w: Array

    def __post_init__(self) -> None:
        _check_ids(self.uav_ids)
        _check_shape("schedule", self.power_w, (self.horizon.count, len(self.uav_ids)))
        _check_powers("schedule.data", self.power_w)


def _check_ids(uav_ids: tuple[str, ...]) -> None:
    if not uav_ids:
        raise MessageError("uav.ids", "is empty")
    if len(set(uav_ids)) != len(uav_ids):
        raise MessageError("uav.ids", f"names a UAV twice: {', '.join(uav_ids)}")
    for uav_id in uav_ids:
        if not uav_id or any(mark in uav_id for mark in ",;="):
            raise MessageError("uav.ids", f"{uav_id!r} is empty or holds one of , ; =")


def _check_shape(name: str, array: AnyArray, shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise MessageError(f"{name}.layout", f"shape is {array.shape}, expected {shape}")


def _check_powers(name: str, power_w: Array) -> None:
    if not np.isfinite(power_w).all():
        raise MessageError(name, "holds a power that is not finite")
    if (power_w < 0).any():
        raise MessageError(name, f"holds a negative power, {power_w.min()} W")
