"""Decides how loudly each UAV transmits."""

from jfto_power.allocation import Allocation, allocate, allocate_prefix
from jfto_power.kkt import kkt_residual, objective_bps
from jfto_power.reference import ReferenceAllocator, SolverError
from jfto_power.shortage import EnergyShortage, affordable_slots

__all__ = [
    "Allocation",
    "EnergyShortage",
    "ReferenceAllocator",
    "SolverError",
    "affordable_slots",
    "allocate",
    "allocate_prefix",
    "kkt_residual",
    "objective_bps",
]
