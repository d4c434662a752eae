"""Independent check of a plan: positions and routes in, violations out.

Shares no code with the search. Everything is computed anew from the plan's own records: the slots'
instants from `positions_m`, ten times finer instants from the routes and the time model that the
plan names, and separation between these, too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jfto_msgs_py.errors import PlanError
from jfto_msgs_py.records.certificate import Certificate, Violation, WayHomeCheck
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.units import dbm_to_w, ratio_to_db
from jfto_planner.routing.certificate.battery import check_battery
from jfto_planner.routing.certificate.between import check_between
from jfto_planner.routing.certificate.ground import GroundRule, check_ground
from jfto_planner.routing.certificate.home import (
    LINKS_S,
    check_home,
    home_places_m,
    home_times_s,
)
from jfto_planner.routing.certificate.instants import Instants, instants_of
from jfto_planner.routing.certificate.keep_out import check_keep_out
from jfto_planner.routing.certificate.mission_size import check_lines, check_mission_size
from jfto_planner.routing.certificate.routes import Flown, check_routes, fly
from jfto_world.radio import make_channel

EnergyFloor = Callable[[Array, float], Array]

FINER = 10


def certify(
    plan: Plan,
    energy_floor: EnergyFloor | None = None,
    ground: GroundRule | None = None,
    home_ground: GroundRule | None = None,
) -> Certificate:
    """Check every constraint of (P1) and the energy floor (P0emax).

    Parameters
    ----------
    plan
        The plan as read from its file.
    energy_floor
        Least energy (A,) in joules that the topology of positions (N + 1, A, 3) costs over slots
        of the given duration in seconds; None leaves energy out.
    ground
        Height that is wanted above the ground along the whole flight; None leaves it out.
    home_ground
        The same for the ways home, where the plan has them.

    Returns
    -------
    Certificate
        Counts, margins and one violation for each UAV (or pair) and slot; `clean` where none is.

    Raises
    ------
    PlanError
        If the plan's records do not fit one another, so that nothing can be checked.
    """
    _require_consistent(plan)
    flown = fly(plan, FINER)
    violations = check_routes(plan, flown)
    violations += _check_totals(plan, flown)
    violations += check_lines(plan)
    violations += check_mission_size(plan)
    if ground is not None:
        violations += check_ground(plan, ground)
    floors: tuple[float, ...] = ()
    if energy_floor is not None:
        positions = np.ascontiguousarray(np.moveaxis(plan.positions_m, 0, 1))
        floor = np.asarray(energy_floor(positions, plan.slots.duration_s), dtype=np.float64)
        floors = tuple(float(joules) for joules in floor)
        violations += _check_energy(plan, floor)
    coarse = plan_instants(plan, np.moveaxis(plan.positions_m, 0, 1), 1)
    fine = plan_instants(plan, flown.positions_m, FINER)
    violations += _check_instants(plan, coarse, fine)
    close, nearest_m = check_between(plan, flown.positions_m)
    violations += close
    lost, home = check_home(plan, home_ground)
    violations += lost + check_battery(plan) + check_keep_out(plan)
    margin, margin_uav, margin_slot = fine.worst_margin()
    return Certificate(
        clean=not violations,
        slot_checks=coarse.short.size,
        slot_violations=int(coarse.short.sum()),
        fine_violations=int(fine.short.sum() + fine.close.sum()),
        worst_margin_db=margin,
        worst_margin_uav=plan.uavs[margin_uav].id,
        worst_margin_slot=margin_slot,
        worst_separation_m=min(nearest_m, float(fine.distance.min(initial=np.inf))),
        energy_floor_j=floors,
        violations=tuple(violations),
        home=None if home is None else _with_links(plan, home),
    )


def _with_links(plan: Plan, home: WayHomeCheck) -> WayHomeCheck:
    """The findings with the shares of time in which the fleet is linked on its way home."""
    seen = plan_instants(plan, home_places_m(plan, home_times_s(plan, LINKS_S)), 1)
    return replace(
        home,
        connected_share=float((seen.components == 1).mean()),
        neighbours_share=float((~seen.short.any(axis=1)).mean()),
    )


def _require_consistent(plan: Plan) -> None:
    uavs, count = len(plan.uavs), plan.slots.count
    if not uavs or len(plan.routes) != uavs:
        raise PlanError(f"plan: {len(plan.routes)} routes for {uavs} UAVs, must be one each.")
    if plan.positions_m.shape != (uavs, count + 1, 3):
        raise PlanError(
            f"plan: positions_m has shape {plan.positions_m.shape}, must be "
            f"{(uavs, count + 1, 3)} for {uavs} UAVs and {count} slots."
        )
    if not np.isfinite(plan.positions_m).all():
        raise PlanError("plan: positions_m holds values that are not finite numbers.")
    for uav, route in zip(plan.uavs, plan.routes, strict=True):
        if len(route.arrival_s) != len(route.waypoint_ids):
            raise PlanError(
                f"plan: {uav.id} has {len(route.arrival_s)} arrivals for "
                f"{len(route.waypoint_ids)} waypoints, must be one each."
            )


def _check_totals(plan: Plan, flown: Flown) -> list[Violation]:
    found = []
    length = float(sum(flown.length_m))
    if length > plan.length_max_m:
        message = f"the routes are {length:.1f} m long together, L_max is {plan.length_max_m:g} m"
        found.append(Violation("total_length", "", None, None, length, plan.length_max_m, message))
    for uav, arrivals in zip(plan.uavs, flown.arrivals_s, strict=True):
        end = float(arrivals[-1])
        # The horizon is rounded in a plan file, and so is each waypoint; T_a,max is not.
        limit = min(uav.t_max_s, plan.slots.horizon_s + 1e-6 * len(arrivals))
        if end > limit:
            message = f"{uav.id} reaches its last waypoint at {end:.2f} s, {limit:.2f} s are given"
            found.append(
                Violation("duration", uav.id, end / plan.slots.duration_s, end, end, limit, message)
            )
    return found


def _check_energy(plan: Plan, floor: Array) -> list[Violation]:
    found = []
    for uav, joules in zip(plan.uavs, floor, strict=True):
        if not joules <= uav.energy_j:  # a floor that is not a number is no proof either
            message = f"{uav.id} needs at least {joules:.1f} J and has {uav.energy_j:g} J"
            found.append(
                Violation("energy", uav.id, None, None, float(joules), uav.energy_j, message)
            )
    return found


def plan_instants(
    plan: Plan, positions_m: Array, finer: int, present: Flags | None = None
) -> Instants:
    """Separation, neighbours and connectivity of positions by a plan's radio and rules.

    Everybody sends at P_max.

    Parameters
    ----------
    plan
        Its radio, powers and rules count.
    positions_m
        (T, A, 3), ENU m.
    finer
        Instants per slot.
    present
        (T, A), leaves UAVs out that are not there; None: all are.

    Returns
    -------
    Instants
        Of each of the T instants.
    """
    channel = make_channel(plan.radio)
    power_w = dbm_to_w(np.array([uav.p_max_dbm for uav in plan.uavs]))
    sensitivity_w = float(dbm_to_w(plan.radio.sensitivity_dbm))
    reach = np.asarray(channel.reach(power_w, sensitivity_w))
    return instants_of(
        positions_m,
        reach_m=np.minimum(reach[:, None], reach[None, :]),
        margin_db=lambda distance, a, b: ratio_to_db(
            channel.gain(distance) * np.minimum(power_w[a], power_w[b]) / sensitivity_w
        ),
        k_min=plan.k_min,
        d_min_m=plan.d_min_m,
        finer=finer,
        present=present,
    )


def _check_instants(plan: Plan, coarse: Instants, fine: Instants) -> list[Violation]:
    """Faults at the slots, one each, and those that lie wholly between slots, one per spell."""
    found = []
    for kind in ("separation", "neighbours", "connected"):
        for view, events in ((coarse, coarse.events(kind)), (fine, fine.hidden_events(kind))):
            for slot, who in events:
                found.append(_violation(plan, view, kind, slot, who))
    return found


def _violation(plan: Plan, view: Instants, kind: str, slot: float, who: int) -> Violation:
    time = slot * plan.slots.duration_s
    at = round(slot * view.finer)
    if kind == "separation":
        a, b = view.pairs[0][who], view.pairs[1][who]
        pair = f"{plan.uavs[a].id}+{plan.uavs[b].id}"
        gap = float(view.distance[at, who])
        message = f"{pair} are {gap:.2f} m apart in slot {slot:g}, d_min is {plan.d_min_m:g} m"
        return Violation(kind, pair, slot, time, gap, plan.d_min_m, message)
    if kind == "neighbours":
        uav = plan.uavs[who].id
        degree = int(view.degree[at, who])
        message = f"{uav} has {degree} neighbours in slot {slot:g}, K_min is {plan.k_min}"
        return Violation(kind, uav, slot, time, degree, plan.k_min, message)
    parts = int(view.components[at])
    message = f"the fleet is in {parts} parts in slot {slot:g}"
    return Violation(kind, "", slot, time, parts, 1, message)
