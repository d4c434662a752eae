"""What a UAV is at, from where it is and how far it has come."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jfto.field.state import FLYING, HOLDING, HOME, LANDED, PAD, SILENT, UNHEARD, UavField
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.vehicle import VehiclePose

IN_THE_AIR = frozenset({FLYING, HOLDING, HOME})
HEARD = frozenset({PAD, FLYING, HOLDING, HOME})
# Poses come several times a second.
SILENT_AFTER_S = 3.0
# A vehicle within this of where it should hold does hold.
_NEAR_M = 5.0
_ON_GROUND_M = 1.0


def phase_of(
    plan: Plan,
    index: int,
    pose: VehiclePose | None,
    age_s: float | None,
    clock_s: float | None,
    done: int,
    *,
    landed: bool,
) -> str:
    """One of the words of `state`; `clock_s` counts from lift-off, `done` waypoints are past."""
    if pose is None or age_s is None:
        return UNHEARD
    if landed:
        return LANDED
    if age_s > SILENT_AFTER_S:
        return SILENT
    if clock_s is None or clock_s < 0:
        return PAD
    route = plan.routes[index].waypoint_ids
    if done < len(route):
        return FLYING
    pad = np.array(plan.uavs[index].start_m)
    here = np.array(pose.position_m)
    if np.linalg.norm((here - pad)[:2]) < _NEAR_M and here[2] - pad[2] < _ON_GROUND_M:
        return LANDED
    last = next(
        (np.array(one.position_m) for one in plan.waypoints if route and one.id == route[-1]), pad
    )
    return HOLDING if np.linalg.norm(here - last) < _NEAR_M else HOME


def fleet_doing(clock_s: float | None, uavs: Sequence[UavField]) -> str:
    """What the fleet as a whole is at."""
    if uavs and all(uav.phase == LANDED for uav in uavs):
        return LANDED
    if clock_s is None or clock_s < 0:
        return "waiting for lift-off"
    if any(uav.phase == FLYING for uav in uavs):
        return FLYING
    return HOME if any(uav.phase == HOME for uav in uavs) else HOLDING
