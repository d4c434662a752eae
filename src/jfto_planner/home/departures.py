"""Who leaves when, on which way, so that the last one is home soonest and nobody meets anybody."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_planner.home.flown_way import FlownWay
from jfto_planner.home.meetings import forbidden, met

# Up to so many UAVs every order of departure is tried; of more, orders of so many swaps.
ALL_ORDERS = 5
ROUNDS = 3
# Nobody waits longer than this for the others.
MOST_WAIT_S = 3600
# A fleet is home so soon after the soonest possible that nothing more is tried.
SOON_S = 0.5


@dataclass(frozen=True)
class Departures:
    """`way[a]` is which of UAV a's ways is flown, begun `wait_s[a]` after its `ready_s[a]`, (A,).

    `end_s` is when the last one is down; no choice could be sooner than `bound_s`.
    """

    way: Ints
    wait_s: Ints
    end_s: float
    bound_s: float


@dataclass
class DepartureSearch:
    """Ways of each UAV and when each is ready to leave, seconds (A,).

    Departures are whole seconds after `ready_s`. UAVs keep `apart_m` even where one of them is
    `apart_s` early or late against another.
    """

    ways: Sequence[Sequence[FlownWay]]
    ready_s: Array
    apart_m: float
    apart_s: float
    _spans: dict[tuple[int, int, int, int], Flags] = field(default_factory=dict)

    def __post_init__(self) -> None:
        shortest = [min(way.duration_s for way in ways) for ways in self.ways]
        self._waits = min(MOST_WAIT_S, math.ceil(sum(shortest) + np.ptp(self.ready_s)))
        self._bound_s = max(
            ready + least for ready, least in zip(self.ready_s, shortest, strict=True)
        )
        self._longest_first = [
            int(a) for a in np.argsort(-(self.ready_s + np.array(shortest)), kind="stable")
        ]

    def best(self) -> Departures | None:
        """The soonest found; None where no order of those tried lets everybody leave."""
        found: Departures | None = None
        for order in self._orders():
            found = self._sooner(found, self._in_order(order))
            if found is not None and found.end_s <= self._bound_s + SOON_S:
                return found
        return self._improved(found) if len(self.ways) > ALL_ORDERS else found

    def _orders(self) -> Iterable[Sequence[int]]:
        first = self._longest_first
        if len(first) <= ALL_ORDERS:
            return itertools.permutations(first)
        lowest = sorted(first, key=lambda a: (self.ways[a][0].points_m[0, 2], a))
        return (first, first[::-1], lowest, lowest[::-1])

    def _improved(self, found: Departures | None) -> Departures | None:
        """Move each UAV to the front of the order, while that helps."""
        order = list(self._longest_first)
        for _ in range(ROUNDS):
            before = found
            for a in list(order):
                moved = [a, *(b for b in order if b != a)]
                found = self._sooner(before_this := found, self._in_order(moved))
                if found is not before_this:
                    order = moved
                if found is not None and found.end_s <= self._bound_s + SOON_S:
                    return found
            if found is before:
                break
        return found

    @staticmethod
    def _sooner(one: Departures | None, other: Departures | None) -> Departures | None:
        if one is None or (other is not None and other.end_s < one.end_s - 1e-9):
            return other
        return one

    def _in_order(self, order: Sequence[int]) -> Departures | None:
        """Everybody as soon as those before it in the order allow; None where one never can."""
        count = len(self.ways)
        way, wait = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
        end_s = 0.0
        for place, a in enumerate(order):
            best: tuple[float, int, int] | None = None
            for c, flown in enumerate(self.ways[a]):
                if best is not None and self.ready_s[a] + flown.duration_s >= best[0]:
                    continue
                taken = np.zeros(self._waits + 1, dtype=np.bool_)
                for b in order[:place]:
                    shifts = self._forbidden(b, int(way[b]), a, c)
                    begin = self._waits - int(wait[b])
                    taken |= shifts[begin : begin + self._waits + 1]
                free = np.flatnonzero(~taken)
                if len(free):
                    done = float(self.ready_s[a] + free[0] + flown.duration_s)
                    if best is None or done < best[0]:
                        best = (done, c, int(free[0]))
            if best is None:
                return None
            way[a], wait[a] = best[1], best[2]
            end_s = max(end_s, best[0])
        return Departures(way, wait, end_s, self._bound_s)

    def _forbidden(self, b: int, way_b: int, a: int, way_a: int) -> Flags:
        """Which waits of a less those of b bring them too near, by whole seconds."""
        if b > a:
            return self._forbidden(a, way_a, b, way_b)[::-1]
        key = (b, way_b, a, way_a)
        if key not in self._spans:
            spans = met(self.ways[b][way_b], self.ways[a][way_a], self.apart_m)
            later_s = float(self.ready_s[a] - self.ready_s[b])
            self._spans[key] = forbidden(spans, self.apart_s, later_s, self._waits)
        return self._spans[key]
