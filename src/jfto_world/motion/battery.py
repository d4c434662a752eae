"""What a flight takes of a battery: the one model of planning, certificate and preflight.

Under way a UAV takes its cruise power, standing in the air its hover power. In wind it moves faster
through the air on the legs against it, and takes power in proportion; every flight ends where it
began, so that this is half of the way at most, and the other half is given nothing back.
"""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.battery import Battery
from jfto_msgs_py.records.plan import Plan

HOUR_S = 3600.0


@dataclass(frozen=True)
class Airborne:
    """Seconds from lift-off until a UAV stands at its pad: under way, and standing in the air."""

    moving_s: float
    still_s: float


@dataclass(frozen=True)
class Drain:
    """Powers of a battery's UAV at its speed in a wind, from any quarter."""

    battery: Battery
    speed_mps: float
    wind_mps: float = 0.0

    @property
    def moving_w(self) -> float:
        """Power under way, the wind's share included."""
        return self.battery.cruise_power_w * (1.0 + self.wind_mps / (2.0 * self.speed_mps))

    @property
    def greatest_w(self) -> float:
        """Power of the part of a flight that takes more."""
        return max(self.moving_w, self.battery.hover_power_w)

    def energy_wh(self, flown: Airborne) -> float:
        """What a flight takes."""
        taken_j = self.moving_w * flown.moving_s + self.battery.hover_power_w * flown.still_s
        return taken_j / HOUR_S

    def endurance_s(self) -> float:
        """How long a full battery lasts at the greater power with its reserve left."""
        return self.battery.usable_wh * HOUR_S / self.greatest_w

    def left_s(self, flown: Airborne) -> float:
        """How much longer the flight could be at the greater power; below 0: it is too long."""
        return (self.battery.usable_wh - self.energy_wh(flown)) * HOUR_S / self.greatest_w


def airborne(plan: Plan, uav: int) -> Airborne:
    """How the UAV with this index spends its flight, which must have a way home.

    Stops that curves make at waypoints count as under way.
    """
    route, home = plan.routes[uav], plan.homes[uav]
    done_s = route.end_s
    if not plan.trajectories:
        # A UAV without waypoints takes off all the same.
        done_s = max(done_s, home.leave_s - home.hold_s)
    stops_s = plan.time_parameters.get("hold_s", 0.0) * len(route.waypoint_ids)
    moving_s = max(done_s - stops_s, 0.0) + home.reached_s[-1] - home.leave_s
    return Airborne(moving_s, home.landed_s - moving_s)


def drain_of(plan: Plan, uav: int) -> Drain | None:
    """Powers of the UAV with this index in the plan's wind; None where its battery is unknown."""
    one = plan.uavs[uav]
    return None if one.battery is None else Drain(one.battery, one.speed_mps, plan.wind_mps)
