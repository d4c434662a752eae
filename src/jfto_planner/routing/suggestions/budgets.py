"""What routes need of one budget: time, length, energy or distance from one another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from jfto_planner.routing.assess import Routes, assess, fleet_positions
from jfto_planner.routing.problem import RoutingProblem
from jfto_planner.routing.suggestions.changes import instants_s
from jfto_world.radio import pairwise_distances

# Times as much of a budget as is there: more than any routes need.
PLENTY = 10.0


@dataclass(frozen=True)
class Cure:
    """A change that makes sound routes possible; `routes` are such routes under the change.

    `kind` is "time", "length", "energy", "separation", "gain", "k_min", "uav", "starts" or
    "clearance"; `amount` is in seconds, metres of L_max, joules of the worst UAV, metres of d_min,
    dB of link budget (both antennas together), neighbours, UAVs, metres and legs, respectively.
    """

    kind: str
    amount: float
    text: str
    routes: Routes


@dataclass(frozen=True)
class Budget:
    """One budget: the `rules` that it is for, by the certificate's kind; what routes `needed` of it
    if that makes them sound, else None; and the problem `without` it.
    """

    rules: frozenset[str]
    needed: Callable[[RoutingProblem, Routes], Cure | None]
    without: Callable[[RoutingProblem], RoutingProblem]


def _time(problem: RoutingProblem, routes: Routes) -> Cure | None:
    seconds = float(np.ceil(assess(problem, routes).late_s))
    horizon = None if problem.horizon_s is None else problem.horizon_s + seconds
    eased = replace(problem, t_max_s=problem.t_max_s + seconds, horizon_s=horizon)
    return _cure("time", seconds, f"t_max_s {seconds:.0f} s longer", eased, routes)


def _without_time(problem: RoutingProblem) -> RoutingProblem:
    return replace(problem, t_max_s=problem.t_max_s * PLENTY, horizon_s=None)


def _length(problem: RoutingProblem, routes: Routes) -> Cure | None:
    metres = float(np.ceil(assess(problem, routes).length_m))
    eased = replace(problem, length_max_m=metres)
    return _cure("length", metres, f"length_max_m {metres:.0f} m", eased, routes)


def _without_length(problem: RoutingProblem) -> RoutingProblem:
    return replace(problem, length_max_m=np.inf)


def _energy(problem: RoutingProblem, routes: Routes) -> Cure | None:
    assert problem.energy_j is not None
    missing = np.maximum(np.array(assess(problem, routes).energy_j) - problem.energy_j, 0.0)
    joules = float(np.ceil(missing.max()))
    eased = replace(problem, energy_j=problem.energy_j + np.where(missing > 0, joules, 0.0))
    return _cure("energy", joules, f"+ {joules:.0f} J for the worst UAV", eased, routes)


def _without_energy(problem: RoutingProblem) -> RoutingProblem:
    return replace(problem, energy_j=None, energy_floor=None)


def _separation(problem: RoutingProblem, routes: Routes) -> Cure | None:
    distance = pairwise_distances(fleet_positions(problem, routes, instants_s(problem, routes)))
    first, second = np.triu_indices(problem.uav_count, 1)
    metres = float(np.floor(distance[:, first, second].min(initial=problem.d_min_m)))
    eased = replace(problem, d_min_m=metres)
    return _cure("separation", metres, f"d_min_m {metres:.0f} m", eased, routes)


def _without_separation(problem: RoutingProblem) -> RoutingProblem:
    return replace(problem, d_min_m=0.0)


def _cure(
    kind: str, amount: float, text: str, eased: RoutingProblem, routes: Routes
) -> Cure | None:
    return Cure(kind, amount, text, routes) if assess(eased, routes).clean else None


BUDGETS = (
    Budget(frozenset({"duration"}), _time, _without_time),
    Budget(frozenset({"total_length"}), _length, _without_length),
    Budget(frozenset({"energy"}), _energy, _without_energy),
    Budget(frozenset({"separation", "between_slots"}), _separation, _without_separation),
)
