"""What vehicles must show before they may be armed, and where a plan and its scenario say so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from jfto_mavlink.mission.limits import Ground
from jfto_msgs_py.records.battery import Battery
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.types import Array
from jfto_world.motion.battery import Airborne, Drain, airborne, drain_of


@dataclass(frozen=True)
class GateSettings:
    """What a vehicle must show before it may be armed.

    `utc_error_max_s` is a quarter of a slot when the plan is held by the clock, None to leave the
    clock out. `wait_s` is how long a vehicle may take to become ready;
    `waited_for`: this only looks, and whoever starts waits again. `wind_max_mps` is what the
    plan leaves room for, None where it does not say. `drains` and `endurance_s` (without the
    reserve) by UAV say how long its charge lasts, 0 or nothing where nobody knows, and `flown` how
    it spends a planned flight; `battery_reserve_percent` of the capacity must be left on the
    ground. `ground` knows the terrain's heights (ENU). `guided`: curves are streamed, and
    `curves_m` (M, 3) by UAV is where they lead, ENU.
    """

    battery_min_percent: int = 50
    battery_reserve_percent: float = 20.0
    gps_fix_min: int = 3
    satellites_min: int = 6
    pad_distance_max_m: float = 15.0
    silent_max_s: float = 3.0
    utc_error_max_s: float | None = None
    wait_s: float = 90.0
    waited_for: bool = False
    wind_max_mps: float | None = None
    drains: Mapping[str, Drain] = field(default_factory=dict)
    flown: Mapping[str, Airborne] = field(default_factory=dict)
    endurance_s: Mapping[str, float] = field(default_factory=dict)
    ground: Ground | None = None
    guided: bool = False
    curves_m: Mapping[str, Array] = field(default_factory=dict)


def gate_settings(
    plan: Plan,
    scenario: Scenario,
    ground: Ground | None,
    *,
    guided: bool = False,
    by_the_clock: bool = False,
) -> GateSettings:
    """The gate of a plan that is flown under a scenario; `by_the_clock`: with time gates."""
    fleet = scenario.fleet
    ids = [uav.id for uav in plan.uavs]
    return GateSettings(
        battery_reserve_percent=fleet.battery_reserve_percent,
        utc_error_max_s=plan.slots.duration_s / 4 if by_the_clock else None,
        wind_max_mps=plan.wind_mps or scenario.trajectory.wind_mps,
        drains=_drains(plan, scenario),
        flown={name: airborne(plan, a) for a, name in enumerate(ids) if plan.homes},
        endurance_s={uav.id: uav.endurance_s for uav in plan.uavs},
        ground=ground,
        guided=guided,
        curves_m=dict(zip(ids, plan.positions_m, strict=True)) if guided else {},
    )


def _drains(plan: Plan, scenario: Scenario) -> dict[str, Drain]:
    """Powers of UAVs as planned, else as the scenario has them, for a capacity that the vehicle
    knows itself.
    """
    fleet, found = scenario.fleet, {}
    for a, (uav, hover_w, cruise_w) in enumerate(
        zip(plan.uavs, fleet.hover_power_w, fleet.cruise_power_w, strict=True)
    ):
        drain = drain_of(plan, a)
        if drain is None and hover_w:
            own = Battery(0.0, hover_w, cruise_w or hover_w, fleet.battery_reserve_percent)
            drain = Drain(own, uav.speed_mps, plan.wind_mps)
        if drain is not None:
            found[uav.id] = drain
    return found
