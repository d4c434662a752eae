"""Height above the ground along the whole flight, not only at waypoints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.records.certificate import Violation
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array
from jfto_planner.routing.certificate.routes import fly

SPACING_M = 1.0
# Bilinear ground between samples, and positions rounded in a plan file.
TOLERANCE_M = 0.05
# So near its pad a vehicle is still climbing from it.
PAD_M = 3.0


@dataclass(frozen=True)
class GroundRule:
    """`height(x_m, y_m)` of the ground in the plan's frame, and the least height above it.

    Until a vehicle is `clearance_m` high for the first time, it needs `start_clearance_m` away
    from its pad.
    """

    height: Callable[[Array, Array], Array]
    clearance_m: float
    start_clearance_m: float


def check_ground(plan: Plan, rule: GroundRule) -> list[Violation]:
    """One violation for each UAV that is too low somewhere, at its worst place."""
    fastest = max(max(uav.speed_mps, uav.climb_mps, uav.descent_mps) for uav in plan.uavs)
    finer = max(1, int(np.ceil(1.5 * fastest * plan.slots.duration_s / SPACING_M)))
    flown = np.moveaxis(fly(plan, finer).positions_m, 1, 0)
    found = []
    for uav, places in zip(plan.uavs, flown, strict=True):
        above, needed = heights_m(places, np.array(uav.start_m), rule)
        missing = needed - above
        worst = int(np.argmax(missing))
        if missing[worst] > TOLERANCE_M:
            slot = worst / finer
            time = slot * plan.slots.duration_s
            message = (
                f"{uav.id} is {above[worst]:.1f} m above the ground at {time:.1f} s, "
                f"{needed[worst]:g} m are wanted"
            )
            value, limit = float(above[worst]), float(needed[worst])
            found.append(Violation("clearance", uav.id, slot, time, value, limit, message))
    return found


def heights_m(places: Array, pad_m: Array, rule: GroundRule) -> tuple[Array, Array]:
    """Height above the ground at places (T, 3) of a flight, and what is needed there, (T,)."""
    above = places[:, 2] - rule.height(places[:, 0], places[:, 1])
    away = np.hypot(*(places[:, :2] - pad_m[:2]).T) > PAD_M
    high = np.maximum.accumulate(above >= rule.clearance_m)
    needed = np.where(high, rule.clearance_m, np.where(away, rule.start_clearance_m, -np.inf))
    return above, needed
