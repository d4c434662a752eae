"""One quintic per leg, for stretches whose legs are too short to reach cruise.

Inner problem: given the durations of all legs, velocities and accelerations at all waypoints by
one convex quadratic programme (least squared jerk over the whole route), a banded linear system.
Outer problem: the durations, shortened one leg at a time while all limits hold.
"""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_planner.smoothing.kernels import control_points, sampled_excess
from jfto_world.compiled import allocating_kernel as kernel

_COARSE, _FINE = 14, 256
_LONGER = 1.04
_STEPS = np.array([0.8, 0.9, 0.95, 0.98, 0.99, 0.995])


@kernel
def least_jerk(fixed: Flags, durations: Array, states: Array) -> None:
    """Fill `states` (M, 3, 3) with the velocities and accelerations of least squared jerk.

    Each leg's jerk is a quadratic Bezier whose coefficients are linear in both ends' velocity and
    acceleration; those of `fixed` joints are kept as they are, positions too.
    """
    count = len(states)
    gram = np.array([[6.0, 3.0, 1.0], [3.0, 4.0, 3.0], [1.0, 3.0, 6.0]]) / 30.0
    matrix = np.zeros((2 * count, 2 * count))
    right = np.zeros((2 * count, 3))
    basis = np.empty((3, 4))
    for leg in range(count - 1):
        t = durations[leg]
        basis[:, 0] = np.array([-0.6, 1.0, -0.4]) * t
        basis[:, 1] = np.array([-3.0, 3.0, -1.0]) * (t * t / 20.0)
        basis[:, 2] = np.array([-0.4, 1.0, -0.6]) * t
        basis[:, 3] = np.array([1.0, -3.0, 3.0]) * (t * t / 20.0)
        weighted = basis.T @ gram / t**5
        hessian = weighted @ basis
        pull = weighted @ np.array([1.0, -2.0, 1.0])
        step = states[leg + 1, 0] - states[leg, 0]
        for i in range(4):
            for j in range(4):
                matrix[2 * leg + i, 2 * leg + j] += hessian[i, j]
            for k in range(3):
                right[2 * leg + i, k] -= pull[i] * step[k]
    for joint in range(count):
        if fixed[joint]:
            for part in range(2):
                row = 2 * joint + part
                for k in range(3):
                    right[:, k] -= matrix[:, row] * states[joint, 1 + part, k]
                matrix[row, :] = 0.0
                matrix[:, row] = 0.0
                matrix[row, row] = 1.0
                right[row] = states[joint, 1 + part]
    solution = np.linalg.solve(matrix, right)
    for joint in range(count):
        if not fixed[joint]:
            states[joint, 1] = solution[2 * joint]
            states[joint, 2] = solution[2 * joint + 1]


@kernel
def _strays(control: Array, start: Array, end: Array, corridor: float) -> bool:
    """Whether a control point is further than `corridor` from the straight leg."""
    step = end - start
    square = step @ step
    for i in range(1, 5):
        offset = control[i] - start
        share = min(1.0, max(0.0, (offset @ step) / square))
        away = offset - share * step
        if away @ away > corridor * corridor * (1.0 + 1e-9):
            return True
    return False


@kernel
def _fits(
    fixed: Flags, cap: Array, durations: Array, corridor: float, lim: Array, samples: int,
    states: Array,
) -> bool:  # fmt: skip
    least_jerk(fixed, durations, states)
    control = np.empty((6, 3))
    for joint in range(len(states)):
        if states[joint, 1] @ states[joint, 1] > cap[joint] * cap[joint]:
            return False
    for leg in range(len(durations)):
        control_points(states[leg], states[leg + 1], durations[leg], control)
        if _strays(control, states[leg, 0], states[leg + 1, 0], corridor):
            return False
        if sampled_excess(control, durations[leg], lim, samples, 1.0) > 1.0:
            return False
    return True


@kernel
def shortest_durations(
    states: Array, fixed: Flags, cap: Array, corridor: float, lim: Array, durations: Array
) -> bool:
    """Shorten the `durations` (M - 1,) of the legs between joints; whether any durations fit.

    `states` (M, 3, 3) holds all positions and the motion at `fixed` joints; the rest is filled.
    First all durations grow together until every limit holds; then single legs shrink in ever
    smaller steps while it still does; then all grow a little where dense samples ask for it.
    """
    tries = 0
    while not _fits(fixed, cap, durations, corridor, lim, _COARSE, states):
        durations *= _LONGER
        tries += 1
        if tries > 60:
            return False
    for step in _STEPS:
        better = True
        while better:
            better = False
            for leg in range(len(durations)):
                kept = durations[leg]
                durations[leg] = kept * step
                if _fits(fixed, cap, durations, corridor, lim, _COARSE, states):
                    better = True
                else:
                    durations[leg] = kept
    for _ in range(200):
        if _fits(fixed, cap, durations, corridor, lim, _FINE, states):
            return True
        durations *= 1.001
    return False
