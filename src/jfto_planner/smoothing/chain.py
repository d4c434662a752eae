"""A route as a chain of states and durations; its short legs replaced by a spline if faster."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array
from jfto_planner.smoothing.kernel.segment import ACCEL, JERK
from jfto_planner.smoothing.kernel.spline import Stretch, shortest_durations
from jfto_planner.smoothing.route_solver import RouteSolver

_TIGHT = 0.6  # share of a leg that knots take up from which it counts as short


@dataclass(frozen=True)
class Chain:
    """States (K, 3, 3) one after another, `durations` (K - 1,) between them.

    `joints` (K,): the index of the route's point that a state belongs to, -1 for knots.
    """

    states: Array
    durations: Array
    joints: NDArray[np.intp]


def chain_of(solver: RouteSolver) -> Chain:
    """The solver's joints and knots in order, with straight lines at constant speed between."""
    states: list[Array] = []
    durations: list[float] = []
    joints: list[int] = []
    last = len(solver.points) - 1
    for k in range(last + 1):
        before, at, after = solver.states[k]
        if k > 0:
            line = float(np.linalg.norm(before[0] - states[-1][0]))
            durations += [line / float(np.linalg.norm(before[1])), solver.durations[k, 0]]
            states += [before, at]
            joints += [-1, k]
        else:
            states.append(at)
            joints.append(k)
        if k < last:
            durations.append(solver.durations[k, 1])
            states.append(after)
            joints.append(-1)
    return Chain(np.array(states), np.array(durations), np.array(joints, dtype=np.intp))


def shorten(chain: Chain, solver: RouteSolver, corridor: float) -> Chain:
    """The chain with each stretch of short legs replaced by a spline where that saves time."""
    reach = np.exp(solver.pars[:-1, 1]) + np.exp(solver.pars[1:, 0])
    tight = (reach > _TIGHT * solver.length) | (solver.speeds < solver.top)
    states, durations, joints = list(chain.states), list(chain.durations), list(chain.joints)
    leg = len(tight) - 1
    while leg >= 0:
        if not tight[leg]:
            leg -= 1
            continue
        first = leg
        while first > 0 and tight[first - 1] and not solver.stop[first]:
            first -= 1
        begin, end = joints.index(first), joints.index(leg + 1)
        begin -= 1 if first > 0 and not solver.stop[first] else 0
        end += 1 if leg + 1 < len(tight) and not solver.stop[leg + 1] else 0
        found = _splined(solver, states[begin : end + 1], joints[begin : end + 1],
                         durations[begin:end], corridor)  # fmt: skip
        if found is not None:
            states[begin : end + 1] = list(found.states)
            joints[begin : end + 1] = list(found.joints)
            durations[begin:end] = list(found.durations)
        leg = first - 1
    return Chain(np.array(states), np.array(durations), np.array(joints, dtype=np.intp))


def _splined(
    solver: RouteSolver, states: list[Array], joints: list[int], durations: list[float],
    corridor: float,
) -> Chain | None:  # fmt: skip
    """Spline through the route's points of a stretch, its ends as they are; None if not faster."""
    kept = [k for k, joint in enumerate(joints) if joint >= 0 or k in (0, len(joints) - 1)]
    times = np.concatenate([[0.0], np.cumsum(durations)])
    best: tuple[float, Array, Array] | None = None
    given = np.diff(times[kept])
    size = np.linalg.norm(np.diff([states[k][0] for k in kept], axis=0), axis=1)
    for spans in (given, 0.7 * given, 0.5 * _stopped_s(size, solver)):
        fixed = np.zeros(len(kept), dtype=np.bool_)
        fixed[[0, -1]] = True
        stretch = Stretch(
            states=np.array([states[k] for k in kept]),
            durations=spans,
            fixed=fixed,
            cap=np.array([solver.cap[joints[k]] if joints[k] >= 0 else np.inf for k in kept]),
            lim=solver.lim,
            corridor=corridor,
            band=np.empty((2 * len(kept), 4)),
            right=np.empty((2 * len(kept), 3)),
            control=np.empty((6, 3)),
        )
        if not shortest_durations(stretch):
            continue
        total = float(np.sum(spans))
        if total < times[-1] and (best is None or total < best[0]):
            best = (total, stretch.states, spans)
    if best is None:
        return None
    return Chain(best[1], best[2], np.array([joints[k] for k in kept], dtype=np.intp))


def _stopped_s(size: Array, solver: RouteSolver) -> Array:
    """Time of legs from rest to rest without cruise, m to s: two ramps of half the length."""
    by_accel = np.sqrt(size * solver.lim[ACCEL] / 1.5)
    by_jerk = np.cbrt(size**2 * solver.lim[JERK] / 6.0)
    return 2.0 * size / np.minimum(by_accel, by_jerk)
