"""Separation between the instants that the other rules are checked at, in continuous time."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.certificate import Violation
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array
from jfto_planner.routing.certificate.routes import TOLERANCE_M, fly

# Chords this short leave an arc by less than a millimetre at 10 m/s².
CHORD_S = 0.02
# Straight legs at constant speed, slot by slot, are the published rule; it says nothing of between.
SLOTS_ONLY = "constant_speed"


def check_between(plan: Plan, positions_m: Array) -> tuple[list[Violation], float]:
    """Pairs too close between instants only, one violation each, and the least distance of all.

    `positions_m` (T, A, 3) are flown at instants of equal spacing; a pair that is too close at one
    of them is left to the check of instants. Chords between instants tell where to look closer.
    """
    first, second = np.triu_indices(len(plan.uavs), 1)
    if plan.time_model == SLOTS_ONLY or not len(first) or len(positions_m) < 2:
        return [], np.inf
    gaps = positions_m[:, first] - positions_m[:, second]
    known = np.linalg.norm(gaps, axis=2).min(axis=0) < plan.d_min_m
    nearest = chord_distance(gaps)
    if (nearest.min(axis=0) < plan.d_min_m + TOLERANCE_M)[~known].any():
        finer = max(1, int(np.ceil(plan.slots.duration_s / CHORD_S)))
        flown = fly(plan, finer).positions_m
        nearest = chord_distance(flown[:, first] - flown[:, second])
    found = []
    worst = nearest.min(axis=0)
    for pair in np.flatnonzero(~known & (worst < plan.d_min_m - TOLERANCE_M)):
        slot = float(nearest[:, pair].argmin()) * plan.slots.count / len(nearest)
        names = f"{plan.uavs[first[pair]].id}+{plan.uavs[second[pair]].id}"
        time_s, gap = slot * plan.slots.duration_s, float(worst[pair])
        message = f"{names} are {gap:.2f} m apart at {time_s:.1f} s, d_min is {plan.d_min_m:g} m"
        found.append(Violation("separation", names, slot, time_s, gap, plan.d_min_m, message))
    return found, float(worst.min())


def chord_distance(gaps: Array) -> Array:
    """Least length of gaps (T, P, 3) on the straight way from one instant to the next, (T-1, P)."""
    begin, step = gaps[:-1], np.diff(gaps, axis=0)
    square = (step**2).sum(axis=2)
    along = -(begin * step).sum(axis=2)
    share = np.clip(np.divide(along, square, out=np.zeros_like(along), where=square > 0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(begin + share[..., None] * step, axis=2))
