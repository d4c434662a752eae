"""One quintic per leg, for stretches whose legs are too short to reach cruise.

Inner problem: given the durations of all legs, velocities and accelerations at all waypoints by
one convex quadratic programme (least squared jerk over the whole route), a banded linear system.
Outer problem: the durations, shortened one leg at a time while all limits hold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_planner.smoothing.kernel.segment import control_points, sampled_excess
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct

_COARSE, _FINE = 14, 256
_LONGER = 1.04
_STEPS = np.array([0.8, 0.9, 0.95, 0.98, 0.99, 0.995])
_HALF_WIDTH = 3

# Jerk of a leg of duration 1 is a quadratic Bezier: its three coefficients for a unit of velocity
# and 20 units of acceleration at the start, the same at the end, and for a unit of way.
_BASIS = np.array([[-0.6, -3.0, -0.4, 1.0], [1.0, 3.0, 1.0, -3.0], [-0.4, -1.0, -0.6, 3.0]])
_WAY = np.array([1.0, -2.0, 1.0])
_GRAM = np.array([[6.0, 3.0, 1.0], [3.0, 4.0, 3.0], [1.0, 3.0, 6.0]]) / 30.0
_HESSIAN, _PULL = _BASIS.T @ _GRAM @ _BASIS, _BASIS.T @ _GRAM @ _WAY


@dataclass(frozen=True, eq=False)
class Stretch(KernelStruct):
    """M joints and the legs between them.

    `states` (M, 3, 3) hold all positions, and the motion at joints that are `fixed` (M,); speeds at
    joints are at most `cap` (M,). `band` (2 M, 4), `right` (2 M, 3) and `control` (6, 3) are room
    to work in.
    """

    states: Array
    durations: Array
    fixed: Flags
    cap: Array
    lim: Array
    corridor: float
    band: Array
    right: Array
    control: Array


@kernel
def shortest_durations(stretch: Stretch) -> bool:
    """Shorten the durations of the legs between joints; whether any durations fit.

    First all durations grow together until every limit holds; then single legs shrink in ever
    smaller steps while it still does; then all grow a little where dense samples ask for it.
    """
    durations = stretch.durations
    tries = 0
    while not _fits(stretch, _COARSE):
        _lengthen(durations, _LONGER)
        tries += 1
        if tries > 60:
            return False
    for number in range(len(_STEPS)):
        better = True
        while better:
            better = False
            for leg in range(len(durations)):
                kept = durations[leg]
                durations[leg] = kept * _STEPS[number]
                if _fits(stretch, _COARSE):
                    better = True
                else:
                    durations[leg] = kept
    for _ in range(200):
        if _fits(stretch, _FINE):
            return True
        _lengthen(durations, 1.001)
    return False


@inner
def _lengthen(durations: Array, factor: float) -> None:
    for leg in range(len(durations)):
        durations[leg] *= factor


@inner
def _fits(stretch: Stretch, samples: int) -> bool:
    """Whether all limits hold; fills the motion at all joints that are not fixed."""
    _least_jerk(stretch)
    states, durations, control = stretch.states, stretch.durations, stretch.control
    for joint in range(len(states)):
        square = 0.0
        for k in range(3):
            square += states[joint, 1, k] ** 2
        if square > stretch.cap[joint] * stretch.cap[joint]:
            return False
    for leg in range(len(durations)):
        control_points(states[leg], states[leg + 1], durations[leg], control)
        if _strays(control, states[leg, 0], states[leg + 1, 0], stretch.corridor):
            return False
        if sampled_excess(control, durations[leg], stretch.lim, samples, 1.0) > 1.0:
            return False
    return True


@inner
def _strays(control: Array, start: Array, end: Array, corridor: float) -> bool:
    """Whether a control point is further than `corridor` from the straight leg."""
    square = 0.0
    for k in range(3):
        square += (end[k] - start[k]) ** 2
    for i in range(1, 5):
        along, away = 0.0, 0.0
        for k in range(3):
            along += (control[i, k] - start[k]) * (end[k] - start[k])
        share = min(1.0, max(0.0, along / square))
        for k in range(3):
            away += (control[i, k] - start[k] - share * (end[k] - start[k])) ** 2
        if away > corridor * corridor * (1.0 + 1e-9):
            return True
    return False


@inner
def _least_jerk(stretch: Stretch) -> None:
    """Fill the velocities and accelerations of least squared jerk at joints that are not fixed.

    Unknowns are velocity and acceleration of one joint after the other, so that the matrix has
    three diagonals beside the main one.
    """
    states, band, right = stretch.states, stretch.band, stretch.right
    _set_up(stretch)
    for joint in range(len(states)):
        if stretch.fixed[joint]:
            for part in range(2):
                _pin(band, right, 2 * joint + part, states[joint, 1 + part])
    _solve(band, right)
    for joint in range(len(states)):
        if not stretch.fixed[joint]:
            for k in range(3):
                states[joint, 1, k] = right[2 * joint, k]
                states[joint, 2, k] = right[2 * joint + 1, k]


@inner
def _set_up(stretch: Stretch) -> None:
    """Fill the lower band of the matrix, band[i, i - j] for j <= i, and the right-hand side."""
    states, band, right = stretch.states, stretch.band, stretch.right
    for row in range(len(band)):
        for k in range(_HALF_WIDTH + 1):
            band[row, k] = 0.0
        for k in range(3):
            right[row, k] = 0.0
    for leg in range(len(stretch.durations)):
        t = stretch.durations[leg]
        power = t**5
        for i in range(4):
            of_i = t if i % 2 == 0 else t * t / 20.0
            for j in range(i + 1):
                of_j = t if j % 2 == 0 else t * t / 20.0
                band[2 * leg + i, i - j] += _HESSIAN[i, j] * of_i * of_j / power
            for k in range(3):
                step = states[leg + 1, 0, k] - states[leg, 0, k]
                right[2 * leg + i, k] -= _PULL[i] * of_i / power * step


@inner
def _pin(band: Array, right: Array, row: int, value: Array) -> None:
    """Give an unknown its value (3,)."""
    for other in range(max(row - _HALF_WIDTH, 0), min(row + _HALF_WIDTH + 1, len(band))):
        low, high = min(row, other), max(row, other)
        if other != row:
            for k in range(3):
                right[other, k] -= band[high, high - low] * value[k]
        band[high, high - low] = 1.0 if other == row else 0.0
    for k in range(3):
        right[row, k] = value[k]


@inner
def _solve(band: Array, right: Array) -> None:
    """Solve a symmetric positive definite system in place, by L D Lᵀ within its band."""
    count = len(band)
    for i in range(count):
        for j in range(max(i - _HALF_WIDTH, 0), i + 1):
            value = band[i, i - j]
            for m in range(max(i - _HALF_WIDTH, 0), j):
                value -= band[i, i - m] * band[j, j - m] * band[m, 0]
            band[i, i - j] = value if i == j else value / band[j, 0]
    for k in range(right.shape[1]):
        for i in range(count):
            for j in range(max(i - _HALF_WIDTH, 0), i):
                right[i, k] -= band[i, i - j] * right[j, k]
        for i in range(count - 1, -1, -1):
            right[i, k] /= band[i, 0]
            for j in range(i + 1, min(i + _HALF_WIDTH + 1, count)):
                right[i, k] -= band[j, j - i] * right[j, k]
