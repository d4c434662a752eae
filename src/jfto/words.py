"""Figures of plans in words, the same on the terminal and in reports."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from jfto_msgs_py.records.certificate import Certificate
from jfto_msgs_py.records.plan import Plan

if TYPE_CHECKING:
    from jfto_planner.coverage import PairOverlaps

ALONE = "no neighbour, fleet of one"


def measured(value: float | None, decimals: int, unit: str, otherwise: str = "–") -> str:
    """A figure with its unit, `otherwise` where there is none."""
    if value is None or not math.isfinite(value):
        return otherwise
    return f"{value:.{decimals}f} {unit}".rstrip()


def least_margin(certificate: Certificate, decimals: int = 1) -> str:
    """The least margin of a link that K_min asks for, and whose it is."""
    margin = measured(certificate.worst_margin_db, decimals, "dB", "")
    if not margin:
        return "no neighbours asked for (K_min 0)"
    return f"{margin} ({certificate.worst_margin_uav}, slot {certificate.worst_margin_slot:g})"


def least_distance(plan: Plan, value_m: float | None) -> str:
    """A least distance between two UAVs of a plan, and what is asked."""
    limit = f" (limit {plan.d_min_m:g} m)"
    return ALONE if len(plan.uavs) == 1 else measured(value_m, 1, "m", "nobody met") + limit


def flight_time(plan: Plan) -> str:
    """How long a plan flies, the way home included where it has one."""
    done_s = max((route.end_s for route in plan.routes), default=0.0)
    if plan.landed_s is None:
        return f"{done_s:.0f} s to the last waypoint; the way home is not planned"
    return f"{plan.landed_s:.0f} s until all have landed, {done_s:.0f} s to the last waypoint"


def sorties(plans: Sequence[Plan], least: int) -> str:
    """How many flights, of whom and how long, and how many it takes at least."""
    fleet = f"{len(plans[0].uavs)} UAV{'s' * (len(plans[0].uavs) > 1)}"
    minutes = [math.ceil((plan.landed_s or plan.slots.horizon_s) / 60) for plan in plans]
    long = f"{min(minutes)} to {max(minutes)}" if min(minutes) < max(minutes) else f"{minutes[0]}"
    return f"{len(plans)} sorties, {fleet}, {long} min each (at least {least} by time)"


def way_home(plan: Plan) -> str:
    """What was found of the ways home; "" where none is planned."""
    found = None if plan.certificate is None else plan.certificate.home
    if found is None:
        return ""
    if len(plan.uavs) == 1:
        return ALONE
    return (
        f"{measured(found.worst_separation_m, 1, 'm')} apart at least, in one network for "
        f"{100 * found.connected_share:.0f} % of it, K_min kept for "
        f"{100 * found.neighbours_share:.0f} %"
    )


def fence(plan: Plan) -> str:
    """What a plan keeps out of and in, and by how much; "" where nobody says."""
    if plan.fence is None:
        return ""
    zones, parts = len(plan.fence.keep_out), len(plan.fence.keep_in)
    texts = [f"{zones} no-fly zone{'s' * (zones > 1)}"] if zones else []
    texts += [f"{parts} area{'s' * (parts > 1)} to stay in"] if parts else []
    passed = len(plan.waypoints) - plan.photo_count
    way = f"{passed} points passed on ways round" if passed else "no way round needed"
    return f"{' and '.join(texts)}, kept by {plan.fence.margin_m:g} m; {way}"


def made_for(plan: Plan) -> str:
    """The wind that a plan was made for."""
    if plan.wind_mps > 0:
        return f"times are for calm air, speeds leave room for {plan.wind_mps:g} m/s of wind"
    return "times are for calm air, speeds leave no room for wind"


def overlap(found: PairOverlaps) -> str:
    """How far neighbouring photos overlap in one direction."""
    if not found.pairs or found.worst is None:
        return "no two photos beside one another"
    return (
        f"{100 * found.least:.0f} % at least (waypoints {found.worst[0]} and {found.worst[1]}), "
        f"5th percentile {100 * found.p05:.0f} %, {found.below} of {found.pairs} pairs below "
        f"{100 * found.wished:.0f} %"
    )
