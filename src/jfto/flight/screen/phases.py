"""What a UAV is at, from where it is and how far it has come."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from jfto.flight.screen.state import FLYING, HOLDING, HOME, LANDED, PAD, SILENT, UNHEARD, UavState
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import VehiclePose

IN_THE_AIR = frozenset({FLYING, HOLDING, HOME})
LINKED = frozenset({PAD, FLYING, HOLDING, HOME})
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
    if pose is None or age_s is None or landed:
        return LANDED if landed else UNHEARD
    if age_s > SILENT_AFTER_S:
        return SILENT
    if clock_s is None or clock_s < 0:
        return PAD
    if done < len(plan.routes[index].waypoint_ids):
        return FLYING
    return _after_last(plan, index, np.array(pose.position_m))


def _after_last(plan: Plan, index: int, here_m: NDArray[np.float64]) -> str:
    """What one is at that has done its waypoints."""
    pad = np.array(plan.uavs[index].start_m)
    if np.linalg.norm((here_m - pad)[:2]) < _NEAR_M and here_m[2] - pad[2] < _ON_GROUND_M:
        return LANDED
    where = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
    route = plan.routes[index].waypoint_ids
    last = np.array(where[route[-1]]) if route else pad
    return HOLDING if np.linalg.norm(here_m - last) < _NEAR_M else HOME


def fleet_doing(clock_s: float | None, uavs: Sequence[UavState]) -> str:
    """What the fleet as a whole is at."""
    if uavs and all(uav.phase == LANDED for uav in uavs):
        return LANDED
    if clock_s is None or clock_s < 0:
        return "waiting for lift-off"
    if any(uav.phase == FLYING for uav in uavs):
        return FLYING
    return HOME if any(uav.phase == HOME for uav in uavs) else HOLDING
