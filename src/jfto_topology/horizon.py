"""C-TOP for the slots ahead, on the fleet as it was measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.network import Adjacency, PowerIntervals, SlotHorizon
from jfto_topology.ctop import Topology, ctop
from jfto_world.motion.fleet_prediction import FleetPrediction
from jfto_world.radio import Channel


@dataclass(frozen=True)
class HorizonSettings:
    """How the horizon moves with the mission.

    `slot_count` is N; a horizon covers `horizon_slots` instants, or all that are left if 0. A pose
    older than `stale_after_s` takes its UAV out; `pose_wait_s` is how long after the beginning of a
    slot newer poses are waited for.
    """

    slot_count: int
    slot_duration_s: float
    horizon_slots: int = 0
    stale_after_s: float = 3.0
    pose_wait_s: float = 0.2

    def __post_init__(self) -> None:
        if self.slot_count < 1 or self.horizon_slots < 0:
            raise InputError("slot_count must be at least 1 and horizon_slots at least 0.")
        for name in ("slot_duration_s", "stale_after_s"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}, must be positive.")
        if not 0 <= self.pose_wait_s < self.slot_duration_s:
            raise InputError(
                f"pose_wait_s is {self.pose_wait_s}, must be from 0 to below the slot's "
                f"{self.slot_duration_s} s."
            )


@dataclass(frozen=True)
class Links:
    """The radio rules: channel, greatest powers by UAV (W), sensitivity (W), K_min and δ."""

    channel: Channel
    p_max_w: dict[str, float]
    sensitivity_w: float
    k_min: int
    delta: int


@dataclass(frozen=True)
class HorizonTopology:
    """Topology of one horizon over the UAVs that are fresh.

    `excluded` names the UAVs left out as stale, `late` those predicted from a pose older than the
    slot. `k_min` is what was asked of so many UAVs, lower than the mission's if too few are left.
    """

    adjacency: Adjacency
    intervals: PowerIntervals
    topology: Topology
    excluded: tuple[str, ...]
    late: tuple[str, ...]
    k_min: int


class TopologyHorizon:
    """Decides when a slot's topology is due, and computes it; knows no clock of its own."""

    def __init__(
        self, prediction: FleetPrediction, links: Links, settings: HorizonSettings
    ) -> None:
        self.prediction = prediction
        self.links = links
        self.settings = settings
        self._solved = -1

    def slot_at(self, now_ns: int) -> int:
        """Slot that a time falls into: 0 before the start, N at the end and after."""
        elapsed_s = (now_ns - self.prediction.start_ns) / 1e9
        slot = int(np.floor(elapsed_s / self.settings.slot_duration_s))
        return min(max(slot, 0), self.settings.slot_count)

    def instant_ns(self, slot: int) -> int:
        """When a slot begins."""
        return self.prediction.start_ns + round(slot * self.settings.slot_duration_s * 1e9)

    def due(self, now_ns: int) -> bool:
        """Whether the current slot is unsolved and its poses have come or were waited for."""
        if not self.prediction.uav_ids:
            return False
        slot = self.slot_at(now_ns)
        if slot <= self._solved:
            return False
        return not self._late(slot, now_ns) or now_ns >= self.deadline_ns(slot)

    def deadline_ns(self, slot: int) -> int:
        """When a slot is solved whether or not its poses have come."""
        return self.instant_ns(slot) + round(self.settings.pose_wait_s * 1e9)

    def solve(self, now_ns: int) -> HorizonTopology | None:
        """Topology from the current slot on; None while fewer than two UAVs are fresh."""
        slot = self.slot_at(now_ns)
        self._solved = slot
        uav_ids = self.prediction.fresh(now_ns, self.settings.stale_after_s)
        if len(uav_ids) < 2:
            return None
        left = self.settings.slot_count + 1 - slot
        count = min(self.settings.horizon_slots or left, left)
        horizon = SlotHorizon(slot, self.instant_ns(slot), self.settings.slot_duration_s, count)
        k_min = min(self.links.k_min, len(uav_ids) - 1)
        topology = ctop(
            self.prediction.positions(uav_ids, horizon.instants_ns),
            self.links.channel,
            np.array([self.links.p_max_w[uav_id] for uav_id in uav_ids]),
            self.links.sensitivity_w,
            k_min,
            self.links.delta,
        )
        bounds_w = np.stack([topology.p_min_w, topology.p_upper_w], axis=-1)
        return HorizonTopology(
            Adjacency(horizon, uav_ids, topology.adjacency),
            PowerIntervals(horizon, uav_ids, bounds_w),
            topology,
            tuple(uav for uav in self.prediction.uav_ids if uav not in uav_ids),
            tuple(uav for uav in self._late(slot, now_ns) if uav in uav_ids),
            k_min,
        )

    def _late(self, slot: int, now_ns: int) -> tuple[str, ...]:
        """UAVs not measured since the slot began; before lift-off, UAVs whose pose is stale."""
        begin_ns = self.instant_ns(slot)
        if now_ns < begin_ns:
            begin_ns = now_ns - round(self.settings.stale_after_s * 1e9)
        return tuple(
            uav_id
            for uav_id in self.prediction.uav_ids
            if (self.prediction.pose_stamp_ns(uav_id) or -1) < begin_ns
        )
