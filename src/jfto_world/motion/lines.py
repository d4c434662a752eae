"""A time model along a route some of whose points the vehicle is not told of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.records.plan import Line
from jfto_msgs_py.types import Array, Ints
from jfto_world.motion.time_model import MotionLimits, TimeModel

_STEP_S = 0.02


@dataclass(frozen=True)
class AlongLines:
    """`TimeModel` of one route: pad, then its waypoints; those inside `lines` are only passed.

    A vehicle flies a line in one go, faster than from point to point of it.
    """

    model: TimeModel
    lines: tuple[Line, ...]

    def leg_matrix(self, points_m: Array, limits: MotionLimits) -> Array:
        """Time of the direct leg between each ordered pair of points, shape (M, M)."""
        return self.model.leg_matrix(points_m, limits)

    def chain_times(self, points_m: Array, limits: MotionLimits) -> Array:
        """Estimated time of each leg from one point to the next, shape (M - 1,)."""
        return self.model.chain_times(points_m, limits)

    def overhead_s(self, limits: MotionLimits) -> float:
        """Time of a whole route beyond the sum of its `leg_matrix` entries, s."""
        return self.model.overhead_s(limits)

    def arrivals(self, route_m: Array, limits: MotionLimits) -> Array:
        """When each point is reached or passed, shape (M,), the first being 0."""
        route = np.asarray(route_m, dtype=np.float64)
        told = self._told(len(route))
        found = np.zeros(len(route))
        found[told] = self.model.arrivals(route[told], limits)
        for line in self.lines:
            # The pad comes first.
            first, last = line.first + 1, line.last + 1
            count = max(int(np.ceil((found[last] - found[first]) / _STEP_S)), 1)
            times = np.linspace(found[first], found[last], count + 1)
            way = route[last] - route[first]
            reach = float(way @ way) or 1.0
            flown = self.model.positions(route[told], limits, times)
            share = np.maximum.accumulate((flown - route[first]) @ way / reach)
            inside = slice(first + 1, last)
            found[inside] = np.interp((route[inside] - route[first]) @ way / reach, share, times)
        return found

    def positions(self, route_m: Array, limits: MotionLimits, times_s: Array) -> Array:
        """Positions at the given times, shape (T, 3)."""
        route = np.asarray(route_m, dtype=np.float64)
        return self.model.positions(route[self._told(len(route))], limits, times_s)

    def _told(self, count: int) -> Ints:
        kept = np.ones(count, dtype=bool)
        for line in self.lines:
            kept[line.first + 2 : line.last + 1] = False
        return np.flatnonzero(kept)


def along(model: TimeModel, lines: Sequence[Line]) -> TimeModel:
    """The model of a route with these lines: itself where there are none."""
    return AlongLines(model, tuple(lines)) if lines else model
