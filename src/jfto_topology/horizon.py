"""C-TOP for the slots ahead, on the fleet as it was measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.network import Adjacency, PowerIntervals, SlotHorizon
from jfto_topology.algorithms.ctop import Topology
from jfto_topology.links import Links
from jfto_topology.slot_clock import SlotClock
from jfto_world.motion.fleet_prediction import FleetPrediction

# A topology takes two.
_LEAST_UAVS = 2


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
class HorizonTopology:
    """Topology of one horizon over the UAVs that are fresh.

    `excluded` names the UAVs left out as stale, `late` those predicted from a pose older than the
    slot. `k_min` is what was asked of so many UAVs in the current slot, lower than the mission's if
    too few are left or the energy does not last for more.
    `blind` says that hardly anybody sends poses, so that all are predicted from their last ones.
    `lag_s` is the fleet's lag, None where nobody is under way, `shift_s` that of the slots.
    """

    adjacency: Adjacency
    intervals: PowerIntervals
    topology: Topology
    excluded: tuple[str, ...]
    late: tuple[str, ...]
    k_min: int
    blind: bool
    lag_s: float | None
    shift_s: float


class TopologyHorizon:
    """Decides when a slot's topology is due, and computes it; knows no clock of its own.

    `links` may be replaced between slots, and `left_j`, the energy left by UAV, kept up to date.
    """

    def __init__(
        self, prediction: FleetPrediction, links: Links, settings: HorizonSettings
    ) -> None:
        self.prediction = prediction
        self.links = links
        self.settings = settings
        self.left_j: dict[str, float] = {}
        self._clock = SlotClock(prediction.start_ns, settings.slot_count, settings.slot_duration_s)
        self._given_up: set[str] = set()
        self._few_since_ns: int | None = None

    @property
    def slot(self) -> int:
        """The slot solved last, -1 before the first."""
        return self._clock.slot

    def next_ns(self, now_ns: int) -> int:
        """When the next slot to be solved begins, as things stand."""
        return self._clock.next_ns(now_ns, self._lag_s(now_ns))

    def deadline_ns(self, now_ns: int) -> int:
        """When that slot is solved whether or not its poses have come."""
        return self.next_ns(now_ns) + round(self.settings.pose_wait_s * 1e9)

    def due(self, now_ns: int) -> bool:
        """Whether a slot is unsolved and its poses have come or were waited for.

        UAVs that were left out of the last slot are not waited for. Where hardly anybody is fresh
        all of a sudden, the clock may have got ahead of the poses: once they are given half a slot.
        """
        if not self.prediction.uav_ids or self._clock.is_young(now_ns):
            return False
        begin_ns = self.next_ns(now_ns)
        if self.slot >= 0 and now_ns < begin_ns:
            return False
        wait_ns = round(self.settings.pose_wait_s * 1e9)
        late = set(self._late(begin_ns, now_ns)) - self._given_up
        if not late and len(self.prediction.uav_ids) - len(self._given_up) >= self._least:
            return True
        if len(self._fresh(now_ns)) >= self._least:
            self._few_since_ns = None
            return now_ns >= begin_ns + wait_ns
        if now_ns < begin_ns + wait_ns:
            return False
        if self._few_since_ns is None or self._few_since_ns > now_ns:
            self._few_since_ns = now_ns
        return now_ns >= self._few_since_ns + round(self.settings.slot_duration_s * 0.5e9)

    def solve(self, now_ns: int) -> HorizonTopology | None:
        """Topology from the slot that is due on; None while fewer than two UAVs were ever measured.

        Where fewer than two are fresh, it is the messages that fail, not the fleet: all that were
        measured before are predicted from what was known last.
        """
        uav_ids = self._fresh(now_ns)
        blind = len(uav_ids) < self._least
        if blind:
            uav_ids = self._measured(now_ns)
        if not uav_ids or len(uav_ids) < self._least:
            return None
        lag_s = self._lag_s(now_ns)
        late = self._late(self.next_ns(now_ns), now_ns)
        self._clock.advance(now_ns, lag_s)
        excluded = tuple(uav for uav in self.prediction.uav_ids if uav not in uav_ids)
        self._given_up = set(excluded)
        slot, t0_ns = self._clock.slot, self._clock.begin_ns
        left = self.settings.slot_count + 1 - slot
        count = min(self.settings.horizon_slots or left, left)
        horizon = SlotHorizon(slot, t0_ns, self.settings.slot_duration_s, count)
        end_ns = horizon.instants_ns[-1] + round(horizon.duration_s * 1e9)
        topology, k_min = self.links.topology(
            uav_ids,
            self.prediction.positions(uav_ids, np.append(horizon.instants_ns, end_ns)),
            horizon.duration_s,
            self.left_j,
        )
        bounds_w = np.stack([topology.p_min_w, topology.p_upper_w], axis=-1)
        return HorizonTopology(
            Adjacency(horizon, uav_ids, topology.adjacency),
            PowerIntervals(horizon, uav_ids, bounds_w),
            topology,
            excluded,
            tuple(uav for uav in late if uav in uav_ids),
            k_min,
            blind,
            lag_s,
            self._clock.shift_s,
        )

    @property
    def _least(self) -> int:
        """How many must be heard for a topology to be of what is there: of a fleet of one, it."""
        return min(_LEAST_UAVS, len(self.prediction.uav_ids))

    def _fresh(self, now_ns: int) -> tuple[str, ...]:
        return self.prediction.fresh(now_ns, self.settings.stale_after_s)

    def _measured(self, now_ns: int) -> tuple[str, ...]:
        """UAVs with a pose from any time, while the mission lasts."""
        if now_ns < self.prediction.start_ns or self.slot >= self.settings.slot_count:
            return ()
        known = self.prediction.pose_stamp_ns
        return tuple(uav for uav in self.prediction.uav_ids if known(uav) is not None)

    def _lag_s(self, now_ns: int) -> float | None:
        return self.prediction.fleet_lag_s(self._fresh(now_ns))

    def _late(self, begin_ns: int, now_ns: int) -> tuple[str, ...]:
        """UAVs not measured since the slot began; before lift-off, UAVs whose pose is stale."""
        if now_ns < begin_ns:
            begin_ns = now_ns - round(self.settings.stale_after_s * 1e9)
        return tuple(
            uav_id
            for uav_id in self.prediction.uav_ids
            if (self.prediction.pose_stamp_ns(uav_id) or -1) < begin_ns
        )
