"""Exact assessment of routes by the definitions, with the problem's own time model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_planner.routing.problem import RoutingProblem
from jfto_world.radio import degrees, pairwise_distances

Routes = tuple[tuple[int, ...], ...]

# Separation and neighbours are also looked at between the slots' instants.
FINER = 10


@dataclass(frozen=True)
class Assessment:
    """What a set of routes amounts to; totals are 0 where a constraint holds.

    `late_s` sums seconds beyond the latest arrival, `deficits` counts UAV × slot checks of the
    neighbour rule that fail, `splits` slots in which the fleet is not connected, `close_pairs`
    pair × slot checks of separation that fail; `fine_faults` counts instants between slots with
    any of these three. `overlong_m` and `energy_over_j` are what exceeds L_max and, summed over
    UAVs, E_max; `low_legs` counts closed legs that are flown, `overfull` waypoints beyond what
    routes may have.
    """

    length_m: float
    makespan_s: float
    late_s: float
    deficits: int
    splits: int
    close_pairs: int
    fine_faults: int
    overlong_m: float
    energy_over_j: float
    energy_j: tuple[float, ...]
    low_legs: int = 0
    overfull: int = 0

    @property
    def clean(self) -> bool:
        """Whether every constraint holds."""
        return not any(self.totals.values())

    @property
    def severity(self) -> float:
        """One figure to compare routes that break constraints by: faults, each in its own unit.

        A second of lateness counts as a failed check, so that the closest routes are not those of
        one UAV that does everything while the others wait for it.
        """
        return (
            self.deficits
            + self.splits
            + self.close_pairs
            + 0.1 * self.fine_faults
            + self.late_s
            + self.energy_over_j
            + 100.0 * self.low_legs
            + 20.0 * self.overfull
            + 1e-3 * self.overlong_m
        )

    @property
    def totals(self) -> dict[str, float]:
        """Violation total of each constraint, by the certificate's kind."""
        return {
            "duration": self.late_s,
            "neighbours": float(self.deficits),
            "connected": float(self.splits),
            "separation": float(self.close_pairs),
            "between_slots": float(self.fine_faults),
            "total_length": self.overlong_m,
            "energy": self.energy_over_j,
            "clearance": float(self.low_legs),
            "items": float(self.overfull),
        }


def route_points(problem: RoutingProblem, uav: int, route: tuple[int, ...]) -> Array:
    """Pad, waypoints and what detours pass on one route, (K, 3)."""
    return problem.line_m(uav, route)


def fleet_positions(problem: RoutingProblem, routes: Routes, times_s: Array) -> Array:
    """Positions (T, A, 3) of all UAVs at the given times."""
    return np.stack(
        [
            problem.time_model.positions(route_points(problem, a, route), limits, times_s)
            for a, (route, limits) in enumerate(zip(routes, problem.limits, strict=True))
        ],
        axis=1,
    )


def assess(problem: RoutingProblem, routes: Routes) -> Assessment:
    """Check routes by the exact definitions at the slots and ten times finer."""
    ends, lengths = [], []
    for a, (route, limits) in enumerate(zip(routes, problem.limits, strict=True)):
        points = route_points(problem, a, route)
        ends.append(problem.time_model.arrivals(points, limits)[-1])
        lengths.append(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    makespan_s = float(max(ends))
    horizon_s = problem.horizon_s if problem.horizon_s is not None else makespan_s
    count = problem.slot_count
    times = np.arange(FINER * count + 1, dtype=np.float64) * (horizon_s / (FINER * count))
    positions = fleet_positions(problem, routes, times)
    deficit, split, close = _faults(problem, positions)
    faulty = deficit.any(axis=1) | split | (close > 0)
    energy, over = np.zeros(0), 0.0
    if problem.energy_floor is not None and problem.energy_j is not None:
        energy = np.asarray(problem.energy_floor(positions[::FINER], horizon_s / count))
        over = float(np.maximum(energy - problem.energy_j, 0.0).sum())
    length = float(sum(lengths))
    return Assessment(
        length_m=length,
        makespan_s=makespan_s,
        late_s=float(np.maximum(np.array(ends) - problem.latest_arrival_s, 0.0).sum()),
        deficits=int(deficit[::FINER].sum()),
        splits=int(split[::FINER].sum()),
        close_pairs=int(close[::FINER].sum()),
        fine_faults=int(faulty.sum() - faulty[::FINER].sum()),
        overlong_m=max(0.0, length - problem.length_max_m),
        energy_over_j=over,
        energy_j=tuple(float(e) for e in energy),
        low_legs=_low_legs(problem, routes),
        overfull=_overfull(problem, routes),
    )


def _low_legs(problem: RoutingProblem, routes: Routes) -> int:
    if problem.closed_legs is None:
        return 0
    legs = [leg for a, route in enumerate(routes) for leg in problem.legs_of(a, route)]
    return sum(int(problem.closed_legs[leg]) for leg in legs)


def _overfull(problem: RoutingProblem, routes: Routes) -> int:
    if problem.most_waypoints is None:
        return 0
    return int(np.maximum([len(route) for route in routes] - problem.most_waypoints, 0).sum())


def _faults(problem: RoutingProblem, positions: Array) -> tuple[Flags, Flags, Ints]:
    """Per instant: UAVs short of neighbours (T, A), split (T,), pairs too close (T,)."""
    uavs = problem.uav_count
    distance = pairwise_distances(positions)
    linked = distance <= problem.pair_reach_m
    linked[:, np.arange(uavs), np.arange(uavs)] = False
    deficit = degrees(linked) < problem.k_min
    upper = np.triu_indices(uavs, 1)
    close = (distance[:, upper[0], upper[1]] < problem.d_min_m).sum(axis=1)
    return deficit, ~is_connected(linked), close


def is_connected(linked: Flags) -> Flags:
    """Whether each graph of (T, A, A) has one component, by doubling the reachable hops."""
    walk = (linked | np.eye(linked.shape[-1], dtype=bool)).astype(np.float32)
    for _ in range(int(np.ceil(np.log2(max(linked.shape[-1], 2))))):
        # Clipped, so that the number of walks cannot overflow.
        walk = np.minimum(walk @ walk, 1.0)
    return np.asarray((walk > 0).all(axis=(1, 2)))
