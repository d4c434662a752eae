"""What transmitting cost each UAV."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto.analysis.comparison import AlgorithmResult
from jfto.analysis.record import RecordedFlight
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.types import Array

MEASURED = "measured by the simulated air"
COMPUTED = "computed from the powers in force"


@dataclass(frozen=True)
class EnergyUse:
    """Joules of one UAV from lift-off until the fleet was done, planned and as flown."""

    uav: str
    budget_j: float
    planned_j: float
    used_j: float
    source: str

    @property
    def overdraft_j(self) -> float:
        """What was used beyond the budget, 0 if nothing."""
        return max(self.used_j - self.budget_j, 0.0)


def energy_use(
    flight: RecordedFlight, plan: Plan, planned: AlgorithmResult, end_s: float
) -> tuple[EnergyUse, ...]:
    """Energy of every UAV up to `end_s` seconds after lift-off."""
    drained = flight.air.get("energy")
    found = []
    for index, uav in enumerate(plan.uavs):
        if drained is not None:
            # Counted from what stood on the meter at lift-off.
            began, ended = np.interp([0.0, end_s], drained.times_s, drained.values[:, index])
            used_j, source = float(ended - began), MEASURED
        else:
            steps = flight.powers[uav.id]
            used_j, source = _integral(steps.times_s, steps.power_w, end_s), COMPUTED
        found.append(
            EnergyUse(uav.id, uav.energy_j, float(planned.energy_j[index]), used_j, source)
        )
    return tuple(found)


def _integral(times_s: Array, power_w: Array, end_s: float) -> float:
    """Energy of steps of power from 0 to `end_s`."""
    begins = np.clip(times_s, 0.0, end_s)
    ends = np.append(begins[1:], end_s)
    return float((power_w * (ends - begins)).sum())
