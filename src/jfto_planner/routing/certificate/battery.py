"""Whether each UAV's battery lasts for its whole flight, from lift-off until it is down."""

from __future__ import annotations

from jfto_msgs_py.records.certificate import Violation
from jfto_msgs_py.records.plan import Plan
from jfto_world.motion.battery import airborne, drain_of


def check_battery(plan: Plan) -> list[Violation]:
    """One violation for each UAV that lands with less than its reserve.

    Nothing for those whose battery is unknown, nor in a plan without ways home.
    """
    found = []
    for index, uav in enumerate(plan.uavs if plan.homes else ()):
        drain = drain_of(plan, index)
        if drain is None:
            continue
        needed_wh, battery = drain.energy_wh(airborne(plan, index)), drain.battery
        if needed_wh > battery.usable_wh:
            message = (
                f"{uav.id} takes {needed_wh:.1f} Wh from lift-off until it stands at its pad, its "
                f"battery of {battery.capacity_wh:g} Wh gives {battery.usable_wh:.1f} Wh with "
                f"{battery.reserve_percent:g} % left. Several sorties (sorties.count), more UAVs "
                "or a larger fleet.battery_wh would do"
            )
            found.append(
                Violation("battery", uav.id, None, None, needed_wh, battery.usable_wh, message)
            )
    return found
