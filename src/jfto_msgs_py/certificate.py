"""What an independent check of a plan found."""

from __future__ import annotations

from dataclasses import dataclass

# Kinds of violation; each names the constraint of the paper or of docs/definitions it belongs to.
KINDS = (
    "visit",  # a waypoint is visited never or more than once (P0once1, P0once2)
    "separation",  # two UAVs are closer than d_min (P0avoid)
    "total_length",  # the routes are longer than L_max together (P0length)
    "neighbours",  # a UAV has fewer than K_min neighbours at P_max (P1kmin)
    "connected",  # the fleet splits into several components at P_max (P0_fullC)
    "duration",  # a UAV reaches its last waypoint after T_a,max (P1tmax)
    "energy",  # the least power that keeps the topology costs more than E_a,max (P0emax)
    "route",  # times, lengths or positions in the plan contradict its own routes
)


@dataclass(frozen=True)
class Violation:
    """One broken constraint.

    `uav` names the UAV at fault ("uav1+uav2" for a pair, "" for the whole fleet), `time_s` the
    instant (None where it has none), `slot` its slot index, fractional between slots. `value` and
    `limit` share a unit that the text in `message` states.
    """

    kind: str
    uav: str
    slot: float | None
    time_s: float | None
    value: float
    limit: float
    message: str


@dataclass(frozen=True)
class Certificate:
    """Result of checking a plan from its positions alone.

    `slot_checks` counts UAV × slot checks of the neighbour rule and `slot_violations` how many of
    them failed; `fine_violations` counts violations of separation and neighbours at ten times finer
    sampling. `worst_margin_db` is the least surplus of received power over the sensitivity on the
    link to a UAV's K_min-th neighbour, at `worst_margin_uav` and `worst_margin_slot`;
    `worst_separation_m` is the least distance between two UAVs; `energy_floor_j` the energy that
    the least powers of the topology cost each UAV.
    """

    clean: bool
    slot_checks: int
    slot_violations: int
    fine_violations: int
    worst_margin_db: float
    worst_margin_uav: str
    worst_margin_slot: float
    worst_separation_m: float
    energy_floor_j: tuple[float, ...]
    violations: tuple[Violation, ...]
