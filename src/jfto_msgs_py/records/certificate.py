"""What an independent check of a plan found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from jfto_msgs_py.records.fields import FILLED, MAY_LACK, NULL_IS_NAN, OneOf, Range

# Kinds of violation; each names the constraint of the paper or the definition it belongs to.
KINDS = (
    "visit",  # a waypoint is visited never or more than once (P0once1, P0once2)
    "separation",  # two UAVs are closer than d_min (P0avoid)
    "total_length",  # the routes are longer than L_max together (P0length)
    "neighbours",  # a UAV has fewer than K_min neighbours at P_max (P1kmin)
    "connected",  # the fleet splits into several components at P_max (P0_fullC)
    "duration",  # a UAV reaches its last waypoint after T_a,max (P1tmax)
    "clearance",  # a UAV is too near the ground
    "keep_out",  # a UAV is in a no-fly zone, or too near to one
    "keep_in",  # a UAV is outside of where it must stay, or too near to its edge
    "home",  # the way home is too near another UAV, or contradicts itself or the route
    "endurance",  # a UAV stands at its pad later than its battery lets it fly
    "battery",  # a flight takes more of a UAV's battery than it may (fleet.battery_wh)
    "energy",  # the least power that keeps the topology costs more than E_a,max (P0emax)
    "line",  # photographs along a line would not be those planned
    "items",  # a UAV's mission has more items than an autopilot holds
    "route",  # times, lengths or positions in the plan contradict its own routes
)

Count = Annotated[int, Range(0)]
# Not a number, null in files, where nothing was measured.
Measured = Annotated[float, NULL_IS_NAN]


@dataclass(frozen=True)
class Violation:
    """One broken constraint.

    `uav` names the UAV at fault ("uav1+uav2" for a pair, "" for the whole fleet), `time_s` the
    instant (None where it has none), `slot` its slot index, fractional between slots. `value` and
    `limit` share a unit that the text in `message` states.
    """

    kind: Annotated[str, OneOf(KINDS)]
    uav: str
    slot: float | None
    time_s: float | None
    value: Measured
    limit: Measured
    message: Annotated[str, FILLED]


@dataclass(frozen=True)
class WayHomeCheck:
    """What was found of the ways home, from the horizon until the last UAV is down at `landed_s`.

    `worst_separation_m` is the least distance between two UAVs. The shares are of time: with the
    fleet in one part, and with K_min neighbours for everybody. They are no rule.
    """

    landed_s: float
    worst_separation_m: Measured
    connected_share: float
    neighbours_share: float


@dataclass(frozen=True)
class Certificate:
    """Result of checking a plan from its positions alone.

    `slot_checks` counts UAV × slot checks of the neighbour rule and `slot_violations` how many of
    them failed; `fine_violations` counts violations of separation and neighbours at ten times finer
    sampling. `worst_margin_db` is the least surplus of received power over the sensitivity on the
    link to a UAV's K_min-th neighbour, at `worst_margin_uav` and `worst_margin_slot`;
    `worst_separation_m` is the least distance between two UAVs; `energy_floor_j` the energy that
    the least powers of the topology cost each UAV; `home` is what was found of the ways home.
    """

    clean: bool
    slot_checks: Count
    slot_violations: Count
    fine_violations: Count
    worst_margin_db: Measured
    worst_margin_uav: str
    worst_margin_slot: Measured
    worst_separation_m: Measured
    energy_floor_j: tuple[Measured, ...]
    violations: tuple[Violation, ...]
    home: WayHomeCheck | None = field(default=None, metadata=MAY_LACK)
