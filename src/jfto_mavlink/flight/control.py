"""Telling a flying vehicle what to do, each command seen to work."""

from __future__ import annotations

from jfto_mavlink.command import command_seen, send_command, set_mode
from jfto_mavlink.dialect import MODES, mavlink
from jfto_mavlink.errors import CommandError, FlightError
from jfto_mavlink.exchange import Context, Exchange, Report
from jfto_mavlink.mission.deliver import Delivered, deliver
from jfto_mavlink.mission.item import Mission
from jfto_mavlink.mission.transfer import Patience

PAUSED, ACTIVE = mavlink.MISSION_STATE_PAUSED, mavlink.MISSION_STATE_ACTIVE
# MISSION_CURRENT comes at the rate asked for.
SEEN_WAIT_S = 3.0


def pause(context: Context) -> Exchange[None]:
    """Stop where it is and hold; the mission waits. Only in AUTO.

    ArduCopter refuses DO_PAUSE_CONTINUE while it takes off or stands at a waypoint: then BRAKE.
    """
    if context.vehicle.mode != MODES["AUTO"]:
        raise FlightError(
            601, f"{context.uav}: is in {context.vehicle.mode_name}; only a mission can be paused."
        )
    try:
        yield from _pause_continue(context, 0.0, PAUSED)
    except CommandError as error:
        if error.code == 501:
            raise
        yield Report(f"{error} It brakes instead.")
        yield from set_mode(context, MODES["BRAKE"])
    yield Report("paused")


def resume(context: Context) -> Exchange[None]:
    """Go on with the mission, after a pause or from another mode in flight."""
    if context.vehicle.mode == MODES["AUTO"]:
        yield from _pause_continue(context, 1.0, ACTIVE)
    else:
        yield from set_mode(context, MODES["AUTO"])
    yield Report("goes on")


def return_home(context: Context) -> Exchange[None]:
    """Fly home and land (RTL)."""
    yield from set_mode(context, MODES["RTL"])
    yield Report("returns home")


def land(context: Context) -> Exchange[None]:
    """Land where it is."""
    yield from set_mode(context, MODES["LAND"])
    yield Report("lands")


def brake(context: Context) -> Exchange[None]:
    """Stop as fast as possible and hold."""
    yield from set_mode(context, MODES["BRAKE"])
    yield Report("holds")


def change_mission(
    context: Context, mission: Mission, first_seq: int = 1, patience: Patience | None = None
) -> Exchange[Delivered]:
    """Replace the mission of a flying vehicle and fly the new one from an item on.

    It holds in BRAKE meanwhile, since in AUTO each stored item restarts the leg and half a mission
    could fly. The current item must be set: the autopilot keeps the old number. After an error it
    goes on holding; the error says which mission is on board.
    """
    was_auto = context.vehicle.mode == MODES["AUTO"]
    if was_auto:
        yield from brake(context)
    delivered = yield from deliver(context, mission, patience)
    yield from send_command(context, mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, (float(first_seq),))
    if was_auto:
        yield from set_mode(context, MODES["AUTO"])
    return delivered


def _pause_continue(context: Context, value: float, state: int) -> Exchange[None]:
    words = "paused" if state == PAUSED else "going on"
    yield from command_seen(
        context,
        mavlink.MAV_CMD_DO_PAUSE_CONTINUE,
        (value,),
        lambda: context.vehicle.mission_state == state,
        words,
        SEEN_WAIT_S,
    )
