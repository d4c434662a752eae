"""One start of the search: anneals in short stretches and verifies what it finds exactly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jfto_planner.routing.assess import Assessment, Routes, assess, fleet_positions
from jfto_planner.routing.kernel.anneal import COUNTERS, TRIED, Search, anneal
from jfto_planner.routing.kernel.energy import energy_proxy
from jfto_planner.routing.kernel.tables import (
    ENERGY,
    LENGTH,
    TOTALS,
    State,
    empty_state,
    empty_work,
)
from jfto_planner.routing.prepare import make_tables
from jfto_planner.routing.problem import RoutingProblem
from jfto_planner.routing.settings import SearchSettings

# Stretches that a budget of moves is divided into, and the longest; between two of them come looks
# at the clock, the user's wish to stop and the exact rules, and a step down in temperature.
STRETCHES = 50
STRETCH_LONGEST, STRETCH_TIMED = 40_000, 10_000
# From this share of the budget on, penalties may only grow.
STRICT_FROM = 0.7
# Extra moves, as a share of the budget, to repair routes that are still not sound at its end.
REPAIR_SHARE = 0.2
# A start from given routes anneals from this share of the usual temperature.
WARM = 0.2
# Weights (metres per unit of violation) at the start, indexed like State.total.
FIRST_WEIGHTS = (1.0, 20.0, 20.0, 20.0, 200.0)
TIGHTER = 0.99

Pace = Callable[[int], float]
Observer = Callable[[float, float, float], None]


@dataclass
class Found:
    """What one start found: the shortest verified routes, and the closest to sound otherwise."""

    routes: Routes | None = None
    length_m: float = np.inf
    closest: Routes | None = None
    closest_severity: float = np.inf
    moves: int = 0


class Annealer:
    """Anneals one set of routes for a problem."""

    def __init__(
        self,
        problem: RoutingProblem,
        settings: SearchSettings,
        seed: int,
        warm_start: Routes | None,
    ) -> None:
        self.problem = problem
        self.tables = make_tables(problem)
        self.search = _new_search(problem, self.tables.slots, self.tables.fine_slots, seed)
        self.found = Found()
        nearest = self.tables.dist[: problem.waypoint_count, : problem.waypoint_count]
        spread = np.where(nearest > 0, nearest, np.inf).min(axis=1, initial=np.inf)
        unit = float(np.mean(spread[np.isfinite(spread)])) if np.isfinite(spread).any() else 1.0
        scale = unit * (1.0 if warm_start is None else WARM)
        self.hottest, self.coldest = settings.hottest * scale, settings.coldest * unit
        self.coldest = min(self.coldest, self.hottest)
        self.ruin_share = settings.ruin_share
        self.stretch = STRETCH_TIMED
        if settings.time_limit_s is None and settings.moves is not None:
            share = settings.moves // (settings.starts * STRETCHES)
            self.stretch = min(max(share, 1), STRETCH_LONGEST)
        if warm_start is not None:
            _put_routes(self.search.cur, warm_start)

    def prepare(self) -> None:
        """Have the kernels compiled or loaded, so that no budget of time pays for it."""
        anneal(self.tables, self.search, 0, self.hottest, self.ruin_share, True)

    def run(self, pace: Pace, stopped: Callable[[], bool], observe: Observer) -> Found:
        """Anneal until the pace says that the budget is used, then repair unless stopped.

        `pace` turns the number of moves done into the share of the budget used; `observe` is told
        the share, the best length and the least violation after every stretch.
        """
        done, fraction = 0, 0.0
        while fraction < 1.0:
            self._stretch(fraction, self.stretch, fraction < STRICT_FROM)
            done += self.stretch
            fraction = pace(done)
            observe(fraction, self.found.length_m, float(self.search.violated[0]))
        if self.found.routes is None and not stopped():
            self._repair(int(done * REPAIR_SHARE))
        self.found.moves = int(self.search.counters[TRIED])
        closest = _routes(self.search.closest)
        if sum(map(len, closest)) == self.problem.waypoint_count:
            self._note(closest, assess(self.problem, closest))
        return self.found

    def _stretch(self, fraction: float, moves: int, may_relax: bool) -> None:
        temperature = self.hottest * (self.coldest / self.hottest) ** fraction
        anneal(self.tables, self.search, moves, temperature, self.ruin_share, may_relax)
        self._verify()

    def _repair(self, moves: int) -> None:
        """Go on from the closest routes with heavy penalties."""
        if self.search.closest.total[LENGTH] < np.inf:
            _put_routes(self.search.cur, _routes(self.search.closest))
        self.search.weights[1:] *= 10.0
        for _ in range(max(1, moves // self.stretch)):
            self._stretch(0.7, self.stretch, False)
            if self.found.routes is not None:
                return

    def _verify(self) -> None:
        """Check the kernel's best routes exactly; correct what misled it if they fail."""
        best = self.search.best
        if not best.total[LENGTH] < self.found.length_m:
            return
        routes = _routes(best)
        assessment = assess(self.problem, routes)
        self._note(routes, assessment)
        best.total[LENGTH] = self.found.length_m
        if not assessment.clean:
            self._learn(routes, assessment)

    def _learn(self, routes: Routes, assessment: Assessment) -> None:
        """Tighten the kernel's view of a constraint that the exact check found broken."""
        if assessment.energy_over_j > 0.0:
            assert self.problem.energy_j is not None
            step_s = assessment.makespan_s / self.problem.slot_count
            if self.problem.horizon_s is not None:
                step_s = self.problem.horizon_s / self.problem.slot_count
            times = np.arange(self.problem.slot_count + 1, dtype=np.float64) * step_s
            spent = energy_proxy(
                fleet_positions(self.problem, routes, times),
                step_s,
                self.problem.k_min,
                self.problem.path_loss_exponent,
            )
            joules = np.maximum(np.array(assessment.energy_j), 1e-12)
            limit = self.problem.energy_j * spent / joules * TIGHTER
            first = not np.isfinite(self.tables.energy_limit[0])
            # Later rates are mixed in slowly: the rate differs from routes to routes.
            self.tables.energy_limit[:] = (
                limit if first else np.minimum(self.tables.energy_limit * TIGHTER, limit)
            )
            self._reset_costs()
        if assessment.late_s > 0.0:
            self.tables.t_max[:] -= assessment.late_s * 1.1
            self._reset_costs()
        if assessment.deficits or assessment.splits or assessment.fine_faults:
            self.tables.reach[:] *= TIGHTER
            self.tables.reach_exact[:] *= TIGHTER
            self._reset_costs()

    def _reset_costs(self) -> None:
        """Have the current routes evaluated anew under the changed tables."""
        self.search.cur.total[:] = np.inf
        self.search.violated[0] = np.inf

    def _note(self, routes: Routes, assessment: Assessment) -> None:
        found = self.found
        if assessment.clean and assessment.length_m < found.length_m:
            found.routes, found.length_m = routes, assessment.length_m
        if assessment.severity < found.closest_severity:
            found.closest, found.closest_severity = routes, assessment.severity


def _new_search(problem: RoutingProblem, slots: int, fine_slots: int, seed: int) -> Search:
    uavs, waypoints = problem.uav_count, problem.waypoint_count
    weights = np.array(FIRST_WEIGHTS)
    assert len(weights) == TOTALS
    assert ENERGY == TOTALS - 1
    return Search(
        cur=empty_state(uavs, waypoints, slots),
        cand=empty_state(uavs, waypoints, slots),
        work=empty_work(uavs, waypoints),
        best=empty_state(uavs, waypoints, 0),
        closest=empty_state(uavs, waypoints, 0),
        violated=np.array([np.inf]),
        weights=weights,
        fine_pos=np.zeros((uavs, 3, fine_slots + 1)),
        fine_mask=np.zeros((uavs, fine_slots + 1), dtype=np.uint64),
        rng=np.array([seed], dtype=np.uint64),
        counters=np.zeros(COUNTERS, dtype=np.int64),
    )


def _put_routes(state: State, routes: Routes) -> None:
    """Set a state's sequences and mark it as not evaluated."""
    state.route_of[:] = -1
    for a, route in enumerate(routes):
        state.size[a] = len(route)
        state.seq[a, : len(route)] = route
        for i, node in enumerate(route):
            state.route_of[node], state.index_of[node] = a, i
    state.total[:] = np.inf


def _routes(state: State) -> Routes:
    return tuple(
        tuple(int(node) for node in state.seq[a, : state.size[a]]) for a in range(len(state.size))
    )
