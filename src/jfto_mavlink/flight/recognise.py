"""What a vehicle is doing that may have been in the air before this program began."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MavlinkError
from jfto_mavlink.exchange import Context, Exchange, wait_for
from jfto_mavlink.mission.deliver import verify
from jfto_mavlink.mission.item import Mission


@dataclass(frozen=True)
class Recognised:
    """A vehicle as found. `differs` says how its mission on board is not the plan's, "" if it is.

    `mode` is "" where it is not in flight; then the mission is not read either.
    """

    heard: bool
    mode: str = ""
    differs: str = ""


def recognise(context: Context, mission: Mission, heard_wait_s: float) -> Exchange[Recognised]:
    """Find out whether a vehicle flies, and read its mission back if it does; changes nothing.

    One that is not heard within `heard_wait_s` is not waited for.
    """
    vehicle = context.vehicle

    def known() -> bool:
        return vehicle.heartbeat_s is not None and vehicle.landed_state is not None

    if not (yield from wait_for(context, known, heard_wait_s)):
        return Recognised(heard=False)
    if not vehicle.armed or vehicle.landed_state == mavlink.MAV_LANDED_STATE_ON_GROUND:
        return Recognised(heard=True)
    try:
        differing = yield from verify(context, mission)
    except MavlinkError as error:
        differing = (str(error),)
    return Recognised(heard=True, mode=vehicle.mode_name, differs=differing[0] if differing else "")
