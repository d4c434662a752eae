"""Following one UAV along its trajectory by its measured positions."""

from __future__ import annotations

import itertools
from collections import deque
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_msgs_py.types import Array
from jfto_world.motion.progress import passes, progress_time

# How well a position is known, and how a UAV's clock along its route may wander, s and s per s.
_POSITION_M = 4.0
_CLOCK_S = 0.3
_CLOCK_RATE = 0.5
# How far a UAV's clock along its route may jump between two poses, besides the time between them.
WINDOW_S = 10.0
# Farther from its route than this a UAV does not follow it; a glitch is over sooner than that.
OFF_ROUTE_M = 40.0
OFF_ROUTE_S = 3.0
# Where two places on the route explain what is measured, both are followed until one fails.
_SUSPECT_M = 12.0
_SAME_S = 2.0
_MOST = 6
_GIVEN_UP = 20.0
_ENTRY = 8.0
_MEMORY_S = 10.0
# A UAV that is behind by that much is as odd as one that is _POSITION_M beside its route.
_ODD_LAG_S = 30.0
# A UAV whose lag grows by that much a second, for so long, stands still.
_STANDS_RATE = 0.7
_STANDS_S = 3.0
# Decides where the route stays in one place, and moves nothing elsewhere.
_LEAST_PULL_MPS = 0.05


@dataclass
class _Guess:
    """One place on the route where the UAV may be, and how badly that fits.

    `off_m` is how far the last position was from there.
    """

    reached_s: float
    cost: float
    off_m: float


class RouteProgress:
    """Where on its trajectory a UAV is, from one position after the other.

    Several places are followed at first, so that a route that crosses itself, a restart in the
    middle of the flight and a lag of any size are told apart by what comes next. Positions may be
    off by 5 m; a jump of less than `OFF_ROUTE_S` is not believed.
    """

    def __init__(self, trajectory: TimedTrajectory) -> None:
        self._start_ns = trajectory.start_ns
        self._times_s = trajectory.offset_ns / 1e9
        self._line_m = np.ascontiguousarray(trajectory.position_m)
        self._guesses: list[_Guess] = []
        self._at_s = 0.0
        self._near_s = 0.0
        self._short_of_end_s = 0.0
        self._lags: deque[tuple[float, float]] = deque()
        self.off_route = False
        self.done = False
        # A first use compiles, for seconds: better now than when the first pose comes in flight.
        passes(self._times_s, self._line_m, self._line_m[0], 0.0, OFF_ROUTE_M)
        self._time_near(self._line_m[0], 0.0, 0.0, WINDOW_S, _LEAST_PULL_MPS)

    @property
    def lag_s(self) -> float:
        """By how much the UAV is behind its trajectory, seconds; negative if ahead."""
        return self._at_s - self._best.reached_s if self._guesses else 0.0

    @property
    def following(self) -> bool:
        """Whether the lag is one that was seen: under way on the route, neither done nor off it."""
        return bool(self._guesses) and not (self.done or self.off_route)

    @property
    def stands(self) -> bool:
        """Whether the UAV has not gone on along its route lately, where it should have."""
        if not (self.following and self._lags):
            return False
        span_s = self._lags[-1][0] - self._lags[0][0]
        grown_s = self._lags[-1][1] - self._lags[0][1]
        return span_s >= 0.8 * _STANDS_S and grown_s >= _STANDS_RATE * span_s

    @property
    def _best(self) -> _Guess:
        return min(self._guesses, key=lambda guess: guess.cost)

    def update(self, stamp_ns: int, position_m: Array) -> None:
        """Take a position (3,) measured at `stamp_ns`, which must be later than the last one."""
        at_s = (stamp_ns - self._start_ns) / 1e9
        if at_s < 0:
            # On the pad a UAV is where it should be.
            self._guesses = []
            self._lags.clear()
            return
        first = not self._guesses
        gap_s = 0.0 if first else at_s - self._at_s
        self._at_s = at_s
        if first:
            self._near_s = self._short_of_end_s = at_s
        for guess in self._guesses:
            self._follow(guess, position_m, gap_s)
        if first or self._best.off_m > _SUSPECT_M:
            self._look_around(position_m)
        self._forget()
        self._judge()
        self._lags.append((at_s, self.lag_s))
        while self._lags[0][0] < at_s - _STANDS_S:
            self._lags.popleft()

    def _follow(self, guess: _Guess, position_m: Array, gap_s: float) -> None:
        expected_s = guess.reached_s + gap_s
        wander_s = _CLOCK_S + _CLOCK_RATE * gap_s
        pull_mps = _POSITION_M / wander_s
        window_s = WINDOW_S + gap_s
        reached_s, guess.off_m = self._time_near(
            position_m, expected_s, expected_s - window_s, expected_s + window_s, pull_mps
        )
        if guess.off_m > OFF_ROUTE_M:
            # A glitch, or a UAV that went elsewhere: nothing is learnt of its lag.
            reached_s = min(expected_s, self._times_s[-1])
        moved = (reached_s - min(expected_s, self._times_s[-1])) / wander_s
        misfit = min((guess.off_m / _POSITION_M) ** 2 + moved**2, _GIVEN_UP)
        guess.cost = guess.cost * np.exp(-gap_s / _MEMORY_S) + misfit
        guess.reached_s = reached_s

    def _look_around(self, position_m: Array) -> None:
        """Add the places on the whole route, up to now, where the UAV could be as well."""
        entry = self._best.cost + _ENTRY if self._guesses else 0.0
        latest_s = self._at_s + WINDOW_S
        places = passes(self._times_s, self._line_m, position_m, latest_s, OFF_ROUTE_M)
        if not self._guesses and not len(places):
            # Far from its route: as if on time, until it is seen on it.
            places = np.array([min(self._at_s, self._times_s[-1])])
        edges = [-np.inf, *(0.5 * (places[1:] + places[:-1])).tolist(), np.inf]
        for low_s, high_s in itertools.pairwise(edges):
            reached_s, off_m = self._time_near(
                position_m, self._at_s, low_s, high_s, _LEAST_PULL_MPS
            )
            if any(abs(guess.reached_s - reached_s) < _SAME_S for guess in self._guesses):
                continue
            odd = ((self._at_s - reached_s) / _ODD_LAG_S) ** 2
            fit = min((off_m / _POSITION_M) ** 2, _GIVEN_UP)
            self._guesses.append(_Guess(reached_s, entry + odd + fit, off_m))

    def _time_near(
        self, position_m: Array, expected_s: float, low_s: float, high_s: float, pull_mps: float
    ) -> tuple[float, float]:
        return progress_time(
            self._times_s, self._line_m, position_m, expected_s, low_s, high_s, pull_mps
        )

    def _forget(self) -> None:
        """Drop guesses that have failed, or met another one."""
        self._guesses.sort(key=lambda guess: guess.cost)
        kept: list[_Guess] = []
        for guess in self._guesses:
            failed = guess.cost > self._guesses[0].cost + _GIVEN_UP
            met = any(abs(guess.reached_s - other.reached_s) < 0.1 for other in kept)
            if not (failed or met) and len(kept) < _MOST:
                kept.append(guess)
        self._guesses = kept

    def _judge(self) -> None:
        best = self._best
        if best.off_m <= OFF_ROUTE_M:
            self._near_s = self._at_s
        self.off_route = self._at_s - self._near_s >= OFF_ROUTE_S
        at_end = best.reached_s >= self._times_s[-1] - 1.0 and best.off_m <= OFF_ROUTE_M
        if not at_end:
            self._short_of_end_s = self._at_s
        # What comes after the last waypoint is no part of the route.
        self.done = self.done or self._at_s - self._short_of_end_s >= OFF_ROUTE_S
