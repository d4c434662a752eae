"""The plan on the same instants as a flight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto.analysis.grid import FINER
from jfto_msgs_py.plan import Plan
from jfto_planner.routing.certificate import plan_instants
from jfto_planner.routing.certificate_instants import Instants
from jfto_planner.routing.certificate_routes import fly


@dataclass(frozen=True, eq=False)
class PlannedFlight:
    """Planned positions (FINER N + 1, A, 3), and what the certificate's rules make of them."""

    position_m: NDArray[np.float64]
    instants: Instants


def planned_flight(plan: Plan) -> PlannedFlight:
    """A plan's flight, recomputed from its routes; raises PlanError where that cannot be."""
    positions = fly(plan, FINER).positions_m
    return PlannedFlight(positions, plan_instants(plan, positions, FINER))
