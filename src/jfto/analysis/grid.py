"""The slots of a mission as they were flown and as planned, and where everybody was then."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto.analysis.record import RecordedFlight, Track
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array, Flags
from jfto_planner.routing.certificate import Instants, fly, plan_instants

FINER = 10
# Poses come several times a second; between two that are further apart a UAV was not seen.
GAP_S = 3.0
_LEAST_SLOT_S = 1e-3


@dataclass(frozen=True, eq=False)
class FlownGrid:
    """Positions at `times_s` (T,), FINER to a slot, slot n beginning at row FINER n.

    `planned_slots` is N of the plan; more slots than that were flown where the fleet ran late.
    `position_m` is (T, A, 3), straight between poses, held beyond the first and last; `present`
    (T, A) says that the UAV had been heard and was heard again, `seen` (T, A) that it was heard
    at that very time.
    """

    times_s: Array
    planned_slots: int
    position_m: Array
    present: Flags
    seen: Flags

    @property
    def slots(self) -> int:
        """Number of slots flown."""
        return (len(self.times_s) - 1) // FINER

    @property
    def middles(self) -> NDArray[np.intp]:
        """Row in the middle of each slot, where its powers are in force; the last slot's only."""
        rows = np.arange(self.slots + 1) * FINER + FINER // 2
        return np.minimum(rows, len(self.times_s) - 1).astype(np.intp)

    def by_slot(self, rows: Array) -> Array:
        """Mean of values at all instants (T, …) over each slot, (slots + 1, …)."""
        last = rows[-1:]
        whole = rows[:-1].reshape(self.slots, FINER, *rows.shape[1:]).mean(axis=1)
        return np.asarray(np.concatenate([whole, last]))


def flown_grid(flight: RecordedFlight, plan: Plan, end_s: float) -> FlownGrid:
    """Slots until everybody has done its waypoints, at `end_s` seconds after lift-off.

    A record that ends earlier has the slots up to there. Raises InputError where no pose is in
    any slot.
    """
    starts = slot_starts(flight, plan, end_s)
    starts = starts[starts <= flight.last_s]
    if len(starts) < 2:
        raise InputError(
            "The bag holds no pose of the plan's UAVs after lift-off, so nothing was flown on "
            "record. Was it recorded with another fleet, or before the start?"
        )
    shares = np.arange(FINER) / FINER
    times = np.concatenate(
        [(starts[:-1, None] + np.diff(starts)[:, None] * shares).ravel(), starts[-1:]]
    )
    columns = [_places(flight.tracks[uav], times) for uav in flight.uav_ids]
    return FlownGrid(
        times_s=times,
        planned_slots=plan.slots.count,
        position_m=np.stack([each[0] for each in columns], axis=1),
        present=np.stack([each[1] for each in columns], axis=1),
        seen=np.stack([each[2] for each in columns], axis=1),
    )


def slot_starts(flight: RecordedFlight, plan: Plan, end_s: float) -> Array:
    """When each slot began, seconds after lift-off: as published, else by the plan's clock.

    The fleet shifts its slots where it runs late. One entry per slot and one for the end; at
    least the plan's, more where the fleet was not done by then.
    """
    duration, count = plan.slots.duration_s, plan.slots.count
    begun = {0: 0.0}
    for adjacency in flight.adjacency:
        first, begin_s = adjacency.horizon.first, flight.seconds(adjacency.horizon.t0_ns)
        # What was published before lift-off was on a start that was only foreseen; a slot that is
        # repeated, as the last one on the way home, goes on.
        if 0 < first <= count and begin_s > 0:
            begun.setdefault(first, begin_s)
    known = np.array(sorted(begun))
    starts = np.interp(np.arange(count + 1), known, [begun[slot] for slot in known.tolist()])
    starts += np.maximum(np.arange(count + 1) - known[-1], 0) * duration
    # A slot that was skipped keeps its number and next to no length.
    least = np.arange(count + 1) * _LEAST_SLOT_S
    starts = np.asarray(np.maximum.accumulate(starts - least) + least)
    # Less than half a slot is no slot: nobody is done to the second.
    extra = int(np.floor((end_s - starts[-1]) / duration + 0.5))
    if extra > 0:
        starts = np.concatenate([starts, starts[-1] + np.arange(1, extra + 1) * duration])
    return np.asarray(starts, dtype=np.float64)


def _places(track: Track, times_s: Array) -> tuple[Array, Flags, Flags]:
    if not track.times_s.size:
        absent = np.zeros(times_s.shape, dtype=np.bool_)
        return track.at(times_s), absent, absent
    after = np.searchsorted(track.times_s, times_s, side="left")
    last = len(track.times_s) - 1
    following = track.times_s[np.minimum(after, last)]
    before = track.times_s[np.maximum(after - 1, 0)]
    # Who stood still on its pad before the first pose, or was seen a moment ago, is there.
    present = (times_s >= track.times_s[0] - GAP_S) & (times_s <= track.times_s[-1] + GAP_S)
    seen = present & ((following - before <= GAP_S) | (after > last) | (after == 0))
    return track.at(times_s), present, seen


@dataclass(frozen=True, eq=False)
class PlannedFlight:
    """Planned positions (FINER N + 1, A, 3), and what the certificate's rules make of them."""

    position_m: Array
    instants: Instants


def planned_flight(plan: Plan) -> PlannedFlight:
    """A plan's flight, recomputed from its routes; raises PlanError where that cannot be."""
    positions = fly(plan, FINER).positions_m
    return PlannedFlight(positions, plan_instants(plan, positions, FINER))
