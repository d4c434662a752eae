"""What would make an infeasible routing problem feasible, tried out and not guessed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from jfto_planner.routing.assess import FINER, Routes, assess, fleet_positions
from jfto_planner.routing.problem import MOST_UAVS, Array, RoutingProblem
from jfto_planner.routing.result import SearchResult
from jfto_planner.routing.search import search
from jfto_planner.routing.settings import SearchSettings
from jfto_world.radio import pairwise_distances

GroundHeight = Callable[[Array, Array], Array]

# Effort of one trial, halvings of the antenna gain, and how far start points are drawn together.
TRIAL = SearchSettings(moves=400_000, starts=2)
HALVINGS = 3
CLOSER = (0.75, 0.5, 0.25)
STEP_DB = 0.1
PAD_SPACING = 1.05
SAME_START = 3.0


@dataclass(frozen=True)
class Cure:
    """A change that makes sound routes possible; `routes` are such routes under the change.

    `kind` is "gain", "k_min", "uav", "starts" or "time"; `amount` is in dB of link budget (both
    antennas together), neighbours, UAVs, metres and seconds, respectively.
    """

    kind: str
    amount: float
    text: str
    routes: Routes


def suggest_cures(
    problem: RoutingProblem,
    result: SearchResult,
    *,
    seed: int,
    trial: SearchSettings = TRIAL,
    ground_height: GroundHeight | None = None,
) -> tuple[Cure, ...]:
    """Find changes that make an infeasible problem feasible, one at a time, by short searches.

    Each cure has been tried: routes that keep every rule under it were found. The energy floor
    belongs to the given fleet and K_min, so a lower K_min is judged by the floor of the higher one
    and a further UAV is only tried where energy is left out. `ground_height` (x, y) -> z puts
    moved pads on the ground; without it they keep their heights. Returns nothing for a feasible
    result.
    """
    if result.feasible:
        return ()
    trials = (
        _gain(problem, result, seed, trial),
        _lower_k_min(problem, result, seed, trial),
        _one_more_uav(problem, seed, trial),
        _closer_starts(problem, seed, trial, ground_height),
        _more_time(problem, result),
    )
    return tuple(cure for found in trials for cure in found)


def missing_gain_db(problem: RoutingProblem, routes: Routes) -> float:
    """Least extra link budget in dB at which routes keep neighbours, connectivity and energy.

    At a gain of g the range grows by g^(1/exponent) and every needed power falls by g.
    """
    exact = assess(problem, routes)
    count = problem.slot_count * FINER
    horizon_s = problem.horizon_s if problem.horizon_s is not None else exact.makespan_s
    times = np.arange(count + 1, dtype=np.float64) * (horizon_s / count)
    distance = pairwise_distances(fleet_positions(problem, routes, times))
    ratio = distance / problem.pair_reach_m
    uavs = problem.uav_count
    ratio[:, np.arange(uavs), np.arange(uavs)] = 0.0
    worst = float(np.sort(ratio, axis=2)[:, :, problem.k_min].max())
    worst = max(worst, float(_bottleneck(ratio).max()))
    needed_db = 10.0 * problem.path_loss_exponent * np.log10(max(worst, 1.0))
    if exact.energy_j and problem.energy_j is not None:
        over = float((np.array(exact.energy_j) / problem.energy_j).max())
        needed_db = max(needed_db, 10.0 * np.log10(max(over, 1.0)))
    return float(needed_db)


def with_gain(problem: RoutingProblem, gain_db: float) -> RoutingProblem:
    """Return the problem with a stronger link budget."""
    ratio = 10.0 ** (gain_db / 10.0)
    energy = None if problem.energy_j is None else problem.energy_j * ratio
    reach = problem.reach_m * ratio ** (1.0 / problem.path_loss_exponent)
    return replace(problem, reach_m=reach, energy_j=energy)


def _bottleneck(ratio: Array) -> Array:
    """Longest edge of the minimum spanning tree of each graph (T, A, A), by Prim's algorithm."""
    rows = np.arange(len(ratio))
    inside = np.zeros(ratio.shape[:2], dtype=bool)
    inside[:, 0] = True
    best = ratio[:, 0].copy()
    longest = np.zeros(len(ratio))
    for _ in range(ratio.shape[1] - 1):
        best_outside = np.where(inside, np.inf, best)
        joined = best_outside.argmin(axis=1)
        longest = np.maximum(longest, best_outside[rows, joined])
        inside[rows, joined] = True
        best = np.minimum(best, ratio[rows, joined])
    return longest


def _gain(
    problem: RoutingProblem, result: SearchResult, seed: int, trial: SearchSettings
) -> Iterator[Cure]:
    """Start from what the closest routes need, then halve the interval by short searches."""
    enough = np.ceil(missing_gain_db(problem, result.routes) / STEP_DB) * STEP_DB
    if enough <= 0.0:
        return
    routes: Routes | None = None
    if assess(with_gain(problem, enough), result.routes).clean:
        routes = result.routes
    too_little = 0.0
    for _ in range(HALVINGS):
        middle = np.round((too_little + enough) / 2 / STEP_DB) * STEP_DB if routes else enough
        if routes is not None and not too_little < middle < enough:
            break
        found = search(with_gain(problem, middle), trial, seed=seed, warm_start=result.routes)
        if found.feasible:
            routes, enough = found.routes, middle
        elif routes is None:
            return
        else:
            too_little = middle
    if routes is not None:
        yield Cure("gain", float(enough), f"+ {enough:.1f} dB antenna gain in all", routes)


def _lower_k_min(
    problem: RoutingProblem, result: SearchResult, seed: int, trial: SearchSettings
) -> Iterator[Cure]:
    for k_min in range(problem.k_min - 1, -1, -1):
        easier = replace(problem, k_min=k_min)
        found = search(easier, trial, seed=seed, warm_start=result.routes)
        if found.feasible:
            yield Cure("k_min", float(k_min), f"K_min {k_min}", found.routes)
            return


def _one_more_uav(problem: RoutingProblem, seed: int, trial: SearchSettings) -> Iterator[Cure]:
    """Try a twin of the UAV with the longest range, on a free pad as central as any."""
    if problem.energy_floor is not None or problem.uav_count == MOST_UAVS:
        return
    twin = int(np.argmax(problem.reach_m))
    found = search(
        replace(
            problem,
            starts_m=np.vstack([problem.starts_m, _free_pad(problem)]),
            limits=(*problem.limits, problem.limits[twin]),
            t_max_s=np.append(problem.t_max_s, problem.t_max_s[twin]),
            reach_m=np.append(problem.reach_m, problem.reach_m[twin]),
        ),
        trial,
        seed=seed,
    )
    if found.feasible:
        yield Cure("uav", 1.0, "1 more UAV", found.routes)


def _free_pad(problem: RoutingProblem) -> Array:
    """Return the pad nearest to all others that lies beside one of them and d_min from all."""
    spacing = max(problem.d_min_m * PAD_SPACING, 1.0)
    angle = np.arange(12) * (np.pi / 6)
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(12)]) * spacing
    spots = (problem.starts_m[:, None, :] + ring).reshape(-1, 3)
    gaps = np.linalg.norm(spots[:, None, :] - problem.starts_m, axis=2)
    cost = np.where(gaps.min(axis=1) >= problem.d_min_m, gaps.sum(axis=1), np.inf)
    return spots[int(np.argmin(cost))]


def _closer_starts(
    problem: RoutingProblem, seed: int, trial: SearchSettings, ground_height: GroundHeight | None
) -> Iterator[Cure]:
    """Draw the pads together about their centre, as little as serves."""
    centre = problem.starts_m.mean(axis=0)
    for share in CLOSER:
        pads = _drawn_together(problem, centre, share)
        if ground_height is not None:
            pads[:, 2] = ground_height(pads[:, 0], pads[:, 1])
        gaps = pairwise_distances(pads) + np.diag(np.full(len(pads), np.inf))
        if gaps.min() < problem.d_min_m:
            return
        found = search(replace(problem, starts_m=pads), trial, seed=seed)
        if found.feasible:
            moved = float(np.linalg.norm((pads - problem.starts_m)[:, :2], axis=1).max())
            yield Cure("starts", moved, f"start points {moved:.0f} m closer", found.routes)
            return


def _drawn_together(problem: RoutingProblem, centre: Array, share: float) -> Array:
    """Pads with the distances of their starting points from a centre scaled by `share`.

    Pads within a few d_min of one another belong to one starting point and move as one.
    """
    gaps = pairwise_distances(problem.starts_m * [1.0, 1.0, 0.0])
    group = (gaps <= SAME_START * problem.d_min_m).argmax(axis=1)
    anchor = np.stack([problem.starts_m[group == group[a]].mean(axis=0) for a in range(len(group))])
    pads = problem.starts_m.copy()
    pads[:, :2] -= (anchor[:, :2] - centre[:2]) * (1.0 - share)
    return pads


def _more_time(problem: RoutingProblem, result: SearchResult) -> Iterator[Cure]:
    """Where time alone is missing, give what the closest routes need."""
    exact = result.assessment
    broken = {kind for kind, total in exact.totals.items() if total > 0.0}
    if broken != {"duration"}:
        return
    seconds = float(np.ceil(exact.late_s))
    horizon = None if problem.horizon_s is None else problem.horizon_s + seconds
    longer = replace(problem, t_max_s=problem.t_max_s + seconds, horizon_s=horizon)
    if assess(longer, result.routes).clean:
        yield Cure("time", seconds, f"T_max {seconds:.0f} s longer", result.routes)
