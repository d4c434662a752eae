"""Why a constraint was broken in flight, as far as the record tells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jfto.analysis.certificate import FlownException
from jfto.analysis.grid import FINER, FlownGrid, PlannedFlight
from jfto.analysis.record import RecordedFlight
from jfto_msgs_py.records.event import WARN
from jfto_msgs_py.records.passage import Passage
from jfto_msgs_py.records.plan import Plan

# An event explains what happens in so many seconds after it, and shortly before it is noticed.
_BEFORE_S, _AFTER_S = 30.0, 5.0
# Deviations worth naming.
_AWAY_M, _LATE_S, _TIGHT_DB = 3.0, 1.0, 1.0
_MOST = 3


class Explainer:
    """Knows plan and flight, and puts causes to exceptions."""

    def __init__(
        self,
        plan: Plan,
        flight: RecordedFlight,
        grid: FlownGrid,
        passages: Sequence[Passage],
        planned: PlannedFlight,
    ) -> None:
        self._plan, self._flight, self._grid = plan, flight, grid
        self._ids = flight.uav_ids
        self._passages = passages
        rows = np.minimum(np.arange(len(grid.times_s)), len(planned.position_m) - 1)
        self._away_m = np.linalg.norm(grid.position_m - planned.position_m[rows], axis=2)
        self._margin_db = planned.instants.margin_db[rows]
        self._near = planned.instants.distance[rows]
        self._pairs = planned.instants.pairs

    def explained(self, one: FlownException) -> FlownException:
        """The exception with its cause."""
        begin = round(one.first_slot * FINER)
        end = max(round(one.last_slot * FINER), begin)
        involved = self._involved(one, begin)
        found = [*self._absent(one, begin, end), *self._events(involved, begin, end)]
        if one.kind not in {"seen", "lost"}:
            found += self._strayed(involved, begin, end)
            found += self._tight(one, begin, end)
        if len(found) > _MOST:
            found = [*found[:_MOST], f"and {len(found) - _MOST} more"]
        return replace(one, cause="; ".join(found))

    def _involved(self, one: FlownException, row: int) -> list[int]:
        """The UAVs whose doing it may be: those named, and for links whom they should hear."""
        named = [self._ids.index(uav) for uav in one.uav.split("+") if uav]
        if one.kind == "connected":
            return list(range(len(self._ids)))
        if one.kind != "neighbours":
            return named
        (uav,) = named
        distance = {
            int(b if a == uav else a): float(self._near[row, k])
            for k, (a, b) in enumerate(zip(*self._pairs, strict=True))
            if uav in (a, b)
        }
        nearest = sorted(distance, key=lambda other: distance[other])
        return [uav, *nearest[: self._plan.k_min]]

    def _absent(self, one: FlownException, begin: int, end: int) -> list[str]:
        if one.kind in {"seen", "lost"}:
            return []
        gone = ~self._grid.present[begin : end + 1].all(axis=0)
        return [f"{self._ids[uav]} was gone" for uav in np.flatnonzero(gone)]

    def _events(self, involved: Sequence[int], begin: int, end: int) -> list[str]:
        names = {self._ids[uav] for uav in involved}
        low = float(self._grid.times_s[begin]) - _BEFORE_S
        high = float(self._grid.times_s[end]) + _AFTER_S
        found = [
            f"{event.text} ({at_s:.0f} s)"
            for event in self._flight.events
            if event.level >= WARN
            # A warning that the rule is about to be broken is no cause.
            and event.kind not in {"k_min", "d_min", "connectivity"}
            and (not event.uav_id or event.uav_id in names)
            and low <= (at_s := self._flight.seconds(event.stamp_ns)) <= high
        ]
        return list(dict.fromkeys(found))

    def _strayed(self, involved: Sequence[int], begin: int, end: int) -> list[str]:
        found = []
        for uav in involved:
            there = self._grid.present[begin : end + 1, uav]
            away_m = float(self._away_m[begin : end + 1, uav][there].max(initial=0.0))
            if away_m <= _AWAY_M:
                continue
            late_s = self._late_s(self._ids[uav], float(self._grid.times_s[begin]))
            timing = ""
            if abs(late_s) > _LATE_S:
                timing = f", {abs(late_s):.1f} s {'late' if late_s > 0 else 'early'}"
            found.append(f"{self._ids[uav]} was {away_m:.0f} m from its planned place{timing}")
        return found

    def _tight(self, one: FlownException, begin: int, end: int) -> list[str]:
        if one.kind != "neighbours":
            return []
        uav = self._ids.index(one.uav)
        planned_db = float(self._margin_db[begin : end + 1, uav].min())
        if planned_db >= _TIGHT_DB:
            return []
        return [f"the plan had only {planned_db:.2f} dB to spare"]

    def _late_s(self, uav: str, at_s: float) -> float:
        """How late a UAV was at the waypoint that it reached last by then, or next."""
        passed = [
            (one.reached_s, one.late_s)
            for one in self._passages
            if one.uav == uav and one.visited and one.reached_s is not None
        ]
        if not passed:
            return 0.0
        nearest = min(passed, key=lambda each: abs(each[0] - at_s))
        return float(nearest[1] or 0.0)
