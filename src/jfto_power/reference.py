"""The same allocation by a general convex solver, to check the exact one against."""

from __future__ import annotations

import warnings
from functools import lru_cache
from typing import Any

import numpy as np

from jfto_msgs_py.errors import JftoError
from jfto_msgs_py.types import Array
from jfto_power.allocation import PowerProblem
from jfto_power.shortage import ROUNDING, check_energy
from jfto_world.radio import noise_w

SETTINGS = {
    "tol_gap_rel": 1e-8,
    "tol_gap_abs": 1e-8,
    "tol_feas": 1e-8,
    # cvxpy's warm start keeps the scaling of the last instance, which fails on the next one.
    "warm_start": False,
}
# Close to the optimum some cones allow tiny steps only, where Clarabel by default gives up; told to
# go on, it solves those but crawls on others.
ATTEMPTS: tuple[dict[str, float], ...] = (
    {},
    {"min_switch_step_length": 1e-3, "min_terminate_step_length": 1e-8},
)


class SolverError(JftoError):
    """The general solver gave up; its status is in the message."""


class ReferenceAllocator:
    """cvxpy + Clarabel, compiled once per (N, A, greatest degree) with parameters.

    Left as printed, (P4) makes the interior-point method fail at signal-to-noise ratios of 1e8.
    Here x in [0, 1] places each power in its interval, p = low + x (high - low), and the rate
    ln(1 + g p) is written as a constant + ln(a + b x) with a = 1/(1 + q), b = q/(1 + q),
    q = g (high - low)/(1 + g low), so that all data lies in [0, 1].
    """

    def solve(self, problem: PowerProblem) -> Array:
        """Powers (N + 1, A) in watts; slot 0, which costs nothing, gets its upper bound.

        Raises EnergyShortage, or SolverError with the status.
        """
        p_low_w, p_high_w, energy = problem.p_low_w, problem.p_high_w, problem.energy_j
        slot_duration_s = problem.slot_duration_s
        check_energy(p_low_w, energy, slot_duration_s, problem.names)
        low, room = p_low_w[1:], p_high_w[1:] - p_low_w[1:]
        linked = problem.adjacency[1:] & (problem.gain[1:] > 0)
        degree = max(1, int(linked.sum(axis=2).max(initial=0)))
        gain = np.where(linked, problem.gain[1:], 0.0)
        snr = _packed(gain, degree) / noise_w(problem.radio)
        spare = np.maximum(energy / slot_duration_s - low.sum(axis=0), 0.0)
        # Without energy to spare only the floor is left, an interval without an inside.
        room = np.where(spare > ROUNDING * low.sum(axis=0), room, 0.0)
        lift = snr * room[:, :, None] / (1.0 + snr * low[:, :, None])
        solver, parts = _compiled(low.shape[0], low.shape[1], degree)
        parts["a"].value = (1.0 / (1.0 + lift)).reshape(low.shape[0], -1)
        parts["b"].value = (lift / (1.0 + lift)).reshape(low.shape[0], -1)
        all_room = np.where(room.sum(axis=0) > 0, room.sum(axis=0), 1.0)
        parts["cost"].value = room / all_room
        parts["spare"].value = np.minimum(spare / all_room, 1.0)
        _run(solver)
        power = np.vstack([p_high_w[:1], low + parts["x"].value * room])
        return np.clip(power, p_low_w, p_high_w)


def _run(problem: Any) -> None:
    import cvxpy as cp

    outcomes = []
    for attempt in ATTEMPTS:
        try:
            with warnings.catch_warnings():
                # The status says it too.
                warnings.filterwarnings("ignore", message="Solution may be inaccurate")
                problem.solve(solver="CLARABEL", **SETTINGS, **attempt)
        except cp.SolverError as error:
            outcomes.append(str(error))
            continue
        if problem.status == cp.OPTIMAL:
            return
        outcomes.append(problem.status)
    raise SolverError(f"Clarabel found no allocation: {'; '.join(outcomes)}")


def _packed(gain: Array, degree: int) -> Array:
    """Each UAV's link gains moved to the front of its row, (N, A, degree)."""
    return -np.sort(-gain, axis=2)[:, :, :degree]


@lru_cache(maxsize=16)
def _compiled(slots: int, uavs: int, degree: int) -> tuple[Any, dict[str, Any]]:
    """Problem of one shape; parameters enter linearly, so that it is compiled only once (DPP)."""
    import cvxpy as cp

    x = cp.Variable((slots, uavs), name="x")
    wide = (slots, uavs * degree)
    parts = {
        "x": x,
        "a": cp.Parameter(wide, nonneg=True),
        "b": cp.Parameter(wide, nonneg=True),
        "cost": cp.Parameter((slots, uavs), nonneg=True),
        "spare": cp.Parameter(uavs, nonneg=True),
    }
    spread = np.kron(np.eye(uavs), np.ones((1, degree)))
    rate = cp.sum(cp.log(parts["a"] + cp.multiply(parts["b"], x @ spread)))
    spent = cp.sum(cp.multiply(parts["cost"], x), axis=0)
    limits = [x >= 0, x <= 1, spent <= parts["spare"]]
    return cp.Problem(cp.Maximize(rate), limits), parts
