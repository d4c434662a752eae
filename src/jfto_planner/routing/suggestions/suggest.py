"""What would make an infeasible routing problem feasible, tried out and not guessed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from jfto_msgs_py.types import GroundHeight
from jfto_planner.routing.assess import Routes, assess
from jfto_planner.routing.problem import MOST_UAVS, RoutingProblem
from jfto_planner.routing.search import SearchResult, search
from jfto_planner.routing.settings import SearchSettings
from jfto_planner.routing.suggestions.budgets import BUDGETS, Cure
from jfto_planner.routing.suggestions.changes import (
    drawn_together,
    free_pad,
    missing_gain_db,
    with_gain,
    with_twin_pad,
)
from jfto_world.radio import pairwise_distances

Progress = Callable[[float, str], None]

# Effort of one trial, halvings of the antenna gain, and how far start points are drawn together.
TRIAL = SearchSettings(moves=400_000, starts=2)
HALVINGS = 3
CLOSER = (0.75, 0.5, 0.25)
STEP_DB = 0.1
# What the gain may have to exceed that of the closest routes by.
MORE_DB = (0.0, 1.0, 3.0)


def suggest_cures(
    problem: RoutingProblem,
    result: SearchResult,
    *,
    seed: int,
    trial: SearchSettings = TRIAL,
    ground_height: GroundHeight | None = None,
    seconds: float = np.inf,
    progress: Progress | None = None,
) -> tuple[Cure, ...]:
    """Find changes that make an infeasible problem feasible, one at a time, by short searches.

    Each cure has been tried: routes that keep every rule under it were found. The energy floor
    belongs to the given fleet and K_min, so a lower K_min is judged by the floor of the higher one
    and a further UAV is only tried where energy is left out.

    Parameters
    ----------
    problem, result
        What could not be solved, and the closest to it.
    seed, trial
        Of each short search, and its effort.
    ground_height
        (x, y) -> z puts moved pads on the ground; without it they keep their heights.
    seconds
        No search begins after that time.
    progress
        Told the share of what there is to try, and what is being tried.

    Returns
    -------
    tuple of Cure
        What needs no search first; nothing for a feasible result.
    """
    if result.feasible:
        return ()
    trials = _Trials(problem, result.routes, seed, trial, time.monotonic() + seconds)
    kinds = {
        "one budget more": trials.one_budget,
        "more antenna gain": trials.gain,
        "a lower K_min": trials.lower_k_min,
        "one more UAV": trials.one_more_uav,
        "closer start points": lambda: trials.closer_starts(ground_height),
        "less clearance": trials.less_clearance,
    }
    found: list[Cure] = []
    for number, (name, attempt) in enumerate(kinds.items()):
        if progress is not None:
            progress(number / len(kinds), name)
        try:
            # One by one, so that those before the time is up are kept.
            for cure in attempt():
                found.append(cure)
        except _OutOfTimeError:
            break
    return tuple(found)


class _OutOfTimeError(Exception):
    """No more searches: the time is up, or the user has stopped one."""


class _Trials:
    """One change of a problem at a time, each tried from the closest routes."""

    def __init__(
        self,
        problem: RoutingProblem,
        routes: Routes,
        seed: int,
        effort: SearchSettings,
        until_s: float,
    ) -> None:
        self.problem, self.routes = problem, routes
        self._seed, self._effort, self._until_s = seed, effort, until_s

    def _has_time(self) -> bool:
        return time.monotonic() < self._until_s

    def _search(self, problem: RoutingProblem, warm: Routes | None) -> SearchResult:
        if not self._has_time():
            raise _OutOfTimeError
        found = search(problem, self._effort, seed=self._seed, warm_start=warm)
        if found.stopped_by == "user" and not found.feasible:
            raise _OutOfTimeError
        return found

    def one_budget(self) -> Iterator[Cure]:
        """What the closest routes need of one budget, or those that a search without it finds."""
        broken = {kind for kind, total in assess(self.problem, self.routes).totals.items() if total}
        for budget in BUDGETS:
            if not budget.rules & broken:
                continue
            cure = budget.needed(self.problem, self.routes)
            if cure is None and len(broken) > 1:
                found = self._search(budget.without(self.problem), self.routes)
                cure = budget.needed(self.problem, found.routes) if found.feasible else None
            if cure is not None:
                yield cure

    def gain(self) -> Iterator[Cure]:
        """Start from what the closest routes need, then halve the interval by short searches."""
        enough = np.ceil(missing_gain_db(self.problem, self.routes) / STEP_DB) * STEP_DB
        if enough <= 0.0:
            return
        too_little, routes = 0.0, self.routes
        if not assess(with_gain(self.problem, enough), routes).clean:
            # The closest routes break another rule as well; others may need a little more.
            for more_db in MORE_DB:
                found = self._search(with_gain(self.problem, enough + more_db), routes)
                if found.feasible:
                    break
            if not found.feasible:
                return
            enough, routes = enough + more_db, found.routes
        for _ in range(HALVINGS):
            middle = np.round((too_little + enough) / 2 / STEP_DB) * STEP_DB
            if not too_little < middle < enough or not self._has_time():
                break
            found = self._search(with_gain(self.problem, middle), self.routes)
            if found.feasible:
                enough, routes = middle, found.routes
            else:
                too_little = middle
        yield Cure("gain", float(enough), f"+ {enough:.1f} dB antenna gain in all", routes)

    def lower_k_min(self) -> Iterator[Cure]:
        """The highest K_min below the given one that can be kept."""
        for k_min in range(self.problem.k_min - 1, -1, -1):
            found = self._search(replace(self.problem, k_min=k_min), self.routes)
            if found.feasible:
                yield Cure("k_min", float(k_min), f"K_min {k_min}", found.routes)
                return

    def one_more_uav(self) -> Iterator[Cure]:
        """Try a twin of the UAV with the longest range, on a free pad as central as any."""
        problem = self.problem
        if problem.energy_floor is not None or problem.uav_count == MOST_UAVS:
            return
        # Ways round no-fly zones are those of the pads as they are.
        if problem.detours is not None:
            return
        twin, pad = int(np.argmax(problem.reach_m)), free_pad(problem)
        larger = replace(
            problem,
            starts_m=np.vstack([problem.starts_m, pad]),
            limits=(*problem.limits, problem.limits[twin]),
            t_max_s=np.append(problem.t_max_s, problem.t_max_s[twin]),
            most_waypoints=None
            if problem.most_waypoints is None
            else np.append(problem.most_waypoints, problem.most_waypoints[twin]),
            reach_m=np.append(problem.reach_m, problem.reach_m[twin]),
            closed_legs=with_twin_pad(problem, pad),
        )
        found = self._search(larger, None)
        if found.feasible:
            yield Cure("uav", 1.0, "1 more UAV", found.routes)

    def closer_starts(self, ground_height: GroundHeight | None) -> Iterator[Cure]:
        """Draw the pads together about their centre, as little as serves."""
        problem = self.problem
        if problem.detours is not None:
            return
        centre = problem.starts_m.mean(axis=0)
        for share in CLOSER:
            pads = drawn_together(problem, centre, share)
            if ground_height is not None:
                pads[:, 2] = ground_height(pads[:, 0], pads[:, 1])
            gaps = pairwise_distances(pads) + np.diag(np.full(len(pads), np.inf))
            if gaps.min() < problem.d_min_m:
                return
            found = self._search(replace(problem, starts_m=pads), None)
            if found.feasible:
                moved = float(np.linalg.norm((pads - problem.starts_m)[:, :2], axis=1).max())
                yield Cure("starts", moved, f"start points {moved:.0f} m closer", found.routes)
                return

    def less_clearance(self) -> Iterator[Cure]:
        """Where legs are closed for the ground, let them be flown."""
        exact = assess(self.problem, self.routes)
        if exact.low_legs == 0 or self.problem.detours is not None:
            return
        found = self._search(replace(self.problem, closed_legs=None), self.routes)
        if found.feasible:
            text = "a higher lift-off (takeoff_m), other pads, or less clearance_m"
            yield Cure("clearance", float(exact.low_legs), text, found.routes)
