"""What would make an infeasible plan possible, from what its certificate found."""

from __future__ import annotations

import math

import numpy as np

from jfto_msgs_py.certificate import Certificate, Violation
from jfto_msgs_py.plan import Plan


def cures(plan: Plan) -> tuple[str, ...]:
    """Changes that would mend the violations of a plan's certificate, each with its size.

    A gain helps twice, at both ends; what a topology costs falls as the gain rises, exactly.
    """
    certificate = plan.certificate
    if certificate is None or certificate.clean:
        return ()
    kinds = {violation.kind for violation in certificate.violations}
    found: list[str] = []
    radio_db = max(_energy_db(plan, certificate), _margin_db(certificate, kinds))
    if radio_db > 0:
        found.append(f"+ {math.ceil(5 * radio_db) / 10:.1f} dB antenna gain at both ends")
    if "energy" in kinds:
        found.append(f"+ {_missing_energy_j(plan, certificate):.0f} J for the worst UAV")
    if kinds & {"neighbours", "connected", "energy"} and plan.k_min > 1:
        found.append(f"K_min {plan.k_min - 1}")
    if "duration" in kinds:
        late = max(v.value - v.limit for v in certificate.violations if v.kind == "duration")
        found += [f"t_max_s {math.ceil(late)} s longer", "1 more UAV"]
    if "total_length" in kinds:
        over = _worst(certificate, "total_length")
        found.append(f"length_max_m at least {math.ceil(over.value)} m")
    if "clearance" in kinds:
        found.append("a higher lift-off (trajectory.takeoff_m), other pads, or less clearance_m")
    if "separation" in kinds:
        closest = min(v.value for v in certificate.violations if v.kind == "separation")
        found.append(f"d_min_m {math.floor(closest)} m or less")
    found.append("a longer search (search.moves, search.starts)")
    return tuple(found)


def _energy_db(plan: Plan, certificate: Certificate) -> float:
    if not certificate.energy_floor_j:
        return 0.0
    budget = np.array([uav.energy_j for uav in plan.uavs])
    worst = float(np.nanmax(np.array(certificate.energy_floor_j) / budget))
    return 10 * math.log10(worst) if worst > 1 else 0.0


def _missing_energy_j(plan: Plan, certificate: Certificate) -> float:
    budget = np.array([uav.energy_j for uav in plan.uavs])
    return math.ceil(float(np.nanmax(np.array(certificate.energy_floor_j) - budget)))


def _margin_db(certificate: Certificate, kinds: set[str]) -> float:
    if not kinds & {"neighbours", "connected"} or not math.isfinite(certificate.worst_margin_db):
        return 0.0
    return max(0.0, -certificate.worst_margin_db)


def _worst(certificate: Certificate, kind: str) -> Violation:
    return next(violation for violation in certificate.violations if violation.kind == kind)
