"""What tests of vehicles of either kind do by hand: fly a mission, and try to arm in vain."""

from __future__ import annotations

from collections.abc import Callable

from jfto_sim.config import VehicleConfig
from jfto_sim.dialect import mavlink as m
from jfto_sim.geodesy import move
from jfto_sim.mission.items import Item
from support.pilot import Pilot

ORIGIN = VehicleConfig().home_units
GUIDED, AUTO, RTL, LAND = 4, 3, 6, 9
Start = Callable[..., Pilot]


def waypoint(east_m: float, north_m: float, up_m: float) -> Item:
    lat, lon = move(*ORIGIN, east_m, north_m)
    return Item(16, 3, x=lat, y=lon, z_m=up_m)


def fly_mission(pilot: Pilot, *places: tuple[float, float, float]) -> None:
    """From the air, through places east, north, up of home."""
    home = Item(16, 0, x=ORIGIN[0], y=ORIGIN[1])
    assert pilot.upload([home, *(waypoint(*place) for place in places)]) == 0
    pilot.order(300)


def refused_with(pilot: Pilot) -> list[str]:
    """What an attempt to arm is answered by, in GUIDED; the motors must stay off."""
    pilot.order(176, 1, GUIDED)
    first = len(pilot.texts())
    assert pilot.command(400, 1) == m.MAV_RESULT_FAILED
    pilot.run(0.5)
    assert not pilot.armed
    return [text for text in pilot.texts()[first:] if text.startswith("Arm: ")]
