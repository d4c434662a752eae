"""Search for the shortest routes that satisfy every constraint of (P1)."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.whole_numbers import checked_seed
from jfto_planner.routing.annealer import Annealer, Found
from jfto_planner.routing.assess import Assessment, Routes, assess
from jfto_planner.routing.problem import RoutingProblem
from jfto_planner.routing.settings import SearchSettings

POLL_S = 0.1


@dataclass(frozen=True)
class SearchResult:
    """Best routes found, or where none satisfies every constraint the closest to it.

    `routes` holds waypoint indices per UAV, `length_m` their summed length; `feasible` says whether
    they keep every rule, `assessment` has the violation totals and the energies. `seconds` is what
    it took by the clock. `stopped_by` is "time limit" or "user" where one of them
    ended the search, else empty. `moves` counts moves tried, `lengths_m` the best sound length of
    each start (inf where it found none).
    """

    routes: Routes
    length_m: float
    feasible: bool
    assessment: Assessment
    moves: int
    seconds: float
    stopped_by: str
    lengths_m: tuple[float, ...]

    @property
    def interrupted(self) -> bool:
        """Whether the search was stopped before it had used its moves."""
        return bool(self.stopped_by)


def search(
    problem: RoutingProblem,
    settings: SearchSettings | None = None,
    *,
    seed: int,
    warm_start: Sequence[Sequence[int]] | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> SearchResult:
    """Find short routes under every constraint of (P1).

    Parameters
    ----------
    problem, settings
        What to solve and how much to spend; default settings fit two cores and half a minute.
    seed
        With the same problem and settings, the same seed gives the same routes on any machine,
        unless a time limit or the user stops the search.
    warm_start
        Routes to start from, waypoint indices per UAV. A sound warm start is never made longer.
    progress
        Called from the calling thread, ten times a second, with the share of the budget used and
        the state in words.

    Returns
    -------
    SearchResult
        Ctrl-C ends the search early and returns the best so far, with `stopped_by` "user".

    Raises
    ------
    InputError
        If `warm_start` does not visit every waypoint exactly once, or the seed is not a whole
        number from 0 to 2147483647.
    """
    settings = settings or SearchSettings()
    given = None if warm_start is None else _checked(problem, warm_start)
    if problem.waypoint_count == 1:
        # The kernel moves waypoints to others near them, which a single one has not.
        checked_seed(seed)
        return _of_one_waypoint(problem)
    monitor = _Monitor(problem, settings, checked_seed(seed), given)
    return monitor.run(progress)


def _of_one_waypoint(problem: RoutingProblem) -> SearchResult:
    """Who flies to the only waypoint: everybody is tried, the shortest sound way counts."""
    begun_s = time.monotonic()
    tried = []
    for flying in range(problem.uav_count):
        routes: Routes = tuple((0,) if a == flying else () for a in range(problem.uav_count))
        tried.append((assess(problem, routes), routes))
    best, routes = min(tried, key=lambda one: (one[0].severity, one[0].length_m))
    return SearchResult(
        routes=routes,
        length_m=best.length_m,
        feasible=best.clean,
        assessment=best,
        moves=len(tried),
        seconds=time.monotonic() - begun_s,
        stopped_by="",
        lengths_m=(best.length_m if best.clean else float("inf"),),
    )


class _Monitor:
    """Runs the starts on threads and gathers what they find."""

    def __init__(
        self,
        problem: RoutingProblem,
        settings: SearchSettings,
        seed: int,
        warm_start: Routes | None,
    ) -> None:
        self.problem, self.settings, self.warm_start = problem, settings, warm_start
        states = np.random.SeedSequence(seed).generate_state(settings.starts, np.uint64)
        self.seeds = [int(state) for state in states]
        self.stopped_by = ""
        self.stop = threading.Event()
        self.reports = [(0.0, float("inf"), float("inf"))] * settings.starts
        self.begun_s = time.monotonic()

    def run(self, progress: Callable[[float, str], None] | None) -> SearchResult:
        workers = min(self.settings.workers or available_cores(), self.settings.starts)
        with ThreadPoolExecutor(workers) as pool:
            futures = [pool.submit(self._start, k) for k in range(self.settings.starts)]
            try:
                self._watch(futures, progress)
            except KeyboardInterrupt:
                self._stop("user")
        return self._gather([future.result() for future in futures])

    def _watch(
        self, futures: list[Future[Found]], progress: Callable[[float, str], None] | None
    ) -> None:
        pending = set(futures)
        try:
            while pending:
                _, pending = wait(pending, timeout=POLL_S)
                if progress is not None:
                    fractions, lengths, violations = zip(*self.reports, strict=True)
                    share = sum(fractions) / len(fractions)
                    progress(share, _note(min(lengths), min(violations)))
        except BaseException:
            self.stop.set()
            raise

    def _stop(self, reason: str) -> None:
        self.stopped_by = self.stopped_by or reason
        self.stop.set()

    def _start(self, index: int) -> Found:
        annealer = Annealer(self.problem, self.settings, self.seeds[index], self.warm_start)
        annealer.prepare()
        begun_s = time.monotonic()

        def observe(fraction: float, length_m: float, violation: float) -> None:
            self.reports[index] = (min(fraction, 1.0), length_m, violation)

        return annealer.run(
            lambda done: self._fraction(done, begun_s), lambda: bool(self.stopped_by), observe
        )

    def _fraction(self, done: int, begun_s: float) -> float:
        """Share of a start's budget used; 1 and more end it."""
        settings = self.settings
        if self.stop.is_set():
            return 1.0
        share = 0.0
        if settings.moves is not None:
            share = done * settings.starts / settings.moves
        if settings.time_limit_s is not None:
            workers = min(settings.workers or available_cores(), settings.starts)
            rounds = -(-settings.starts // workers)
            spent = (time.monotonic() - begun_s) * rounds / settings.time_limit_s
            if share < 1.0 <= spent:
                self.stopped_by = self.stopped_by or "time limit"
            share = max(share, spent)
        return share

    def _gather(self, found: list[Found]) -> SearchResult:
        lengths = tuple(one.length_m for one in found)
        best = int(np.argmin(lengths))
        feasible = found[best].routes is not None
        routes = found[best].routes
        if routes is None:
            closest = min(found, key=lambda one: one.closest_severity)
            routes = closest.closest
            assert routes is not None, "a finished start always leaves complete routes"
        assessment = assess(self.problem, routes)
        return SearchResult(
            routes=routes,
            length_m=assessment.length_m,
            feasible=feasible,
            assessment=assessment,
            moves=sum(one.moves for one in found),
            seconds=time.monotonic() - self.begun_s,
            stopped_by=self.stopped_by,
            lengths_m=lengths,
        )


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _note(length_m: float, violation: float) -> str:
    if np.isfinite(length_m):
        return f"best {length_m / 1000:.2f} km"
    return f"nothing sound yet, violation {violation:.3g}" if np.isfinite(violation) else ""


def _checked(problem: RoutingProblem, routes: Sequence[Sequence[int]]) -> Routes:
    if len(routes) != problem.uav_count:
        raise InputError(f"warm_start has {len(routes)} routes for {problem.uav_count} UAVs.")
    result = tuple(tuple(int(node) for node in route) for route in routes)
    if sorted(node for route in result for node in route) != list(range(problem.waypoint_count)):
        raise InputError(
            f"warm_start does not visit each of the waypoints 0 to {problem.waypoint_count - 1} "
            "exactly once."
        )
    return result
