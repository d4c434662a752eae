"""How late UAVs may be at their last waypoints: as given, and so that batteries bring them home."""

from __future__ import annotations

import math

import numpy as np

from jfto.planning.speeds import fleet_limits, planned_wind_mps
from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.battery import Battery
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.types import Array
from jfto_world.motion import ConstantSpeed
from jfto_world.motion.battery import HOUR_S, Drain
from jfto_world.motion.landing import LAND_FROM_M, landing_s

# What each UAV of a fleet may have to wait for the others before it leaves for home.
WAIT_S = 2.0


def battery_of(scenario: Scenario, uav: int) -> Battery | None:
    """Battery of the UAV with this index, None where it is not known."""
    fleet = scenario.fleet
    if not fleet.battery_wh[uav]:
        return None
    hover_w = fleet.hover_power_w[uav]
    return Battery(
        fleet.battery_wh[uav],
        hover_w,
        fleet.cruise_power_w[uav] or hover_w,
        fleet.battery_reserve_percent,
    )


def latest_arrivals_s(scenario: Scenario, waypoints_m: Array, pads_m: Array) -> Array:
    """T_a,max of each UAV (A,) for waypoints (W, 3) from pads (A, 3), s.

    That is fleet.t_max_s, and no later than its battery lets it come home from the farthest
    waypoint; fleet.endurance_s takes the battery's place where that is not known. Raises
    InfeasibleError where nothing is left.
    """
    fleet, latest = scenario.fleet, np.array(scenario.fleet.t_max_s)
    for a, limits in enumerate(fleet_limits(scenario)):
        battery = battery_of(scenario, a)
        if battery is None and latest[a] > 0:
            # The endurance may still be broken: then rounds of the search draw the arrivals in.
            continue
        points = np.concatenate([pads_m[a : a + 1], waypoints_m])
        home_s = float(ConstantSpeed().leg_matrix(points, limits)[1:, 0].max())
        stand_s = landing_s(LAND_FROM_M) + WAIT_S * fleet.count
        if battery is None:
            allowed_s = fleet.endurance_s[a] - home_s - stand_s
        else:
            drain = Drain(battery, limits.speed_mps, planned_wind_mps(scenario))
            left_wh = battery.usable_wh - battery.hover_power_w * stand_s / HOUR_S
            allowed_s = left_wh * HOUR_S / drain.greatest_w - home_s
        if allowed_s <= home_s:
            raise InfeasibleError(
                f"{fleet.ids[a]} cannot come home from the farthest waypoint: it is {home_s:.0f} s "
                f"away, and the battery leaves {max(allowed_s, 0.0):.0f} s to get there.",
                cures=("a larger fleet.battery_wh, or fleet.endurance_s", "starts nearer to it"),
            )
        latest[a] = min(latest[a] or math.inf, math.floor(allowed_s))
    return latest


def longest_arrivals_s(scenario: Scenario) -> Array:
    """No UAV (A,) can be later at its last waypoint, wherever that is, s."""
    fleet, latest = scenario.fleet, np.array(scenario.fleet.t_max_s)
    latest[latest == 0] = np.inf
    for a, limits in enumerate(fleet_limits(scenario)):
        battery = battery_of(scenario, a)
        if battery is not None:
            drain = Drain(battery, limits.speed_mps, planned_wind_mps(scenario))
            least_w = min(drain.moving_w, battery.hover_power_w)
            latest[a] = min(latest[a], battery.usable_wh * HOUR_S / least_w)
        if fleet.endurance_s[a]:
            latest[a] = min(latest[a], fleet.endurance_s[a])
    return latest
