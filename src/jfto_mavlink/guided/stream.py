"""GUIDED flight of one vehicle: from the pad to a hover, a stream of targets, and home."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from jfto_mavlink.dialect import MODES, mavlink
from jfto_mavlink.errors import CommandError, FlightError, MavlinkError
from jfto_mavlink.flight.control import (
    AIRBORNE,
    LIFT_OFF_WAIT_S,
    StartLine,
    line_up,
    return_home,
)
from jfto_mavlink.guided.curve_clock import Progress
from jfto_mavlink.guided.scheduler import GuidedSettings, Scheduler
from jfto_mavlink.guided.target import EkfFrame, HeadingPlan, MapFrame, stop_message, target_message
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.protocol.command import command_seen, request_message, send_command, set_mode
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Send, wait_for, wait_until
from jfto_msgs_py.records.event import ERROR, Event
from jfto_msgs_py.records.vehicle import TimedTrajectory

# Zero velocities sent before BRAKE is asked for: one may be lost.
STOPS = 3
STOP_EVERY_S = 0.05
FRAME_WAIT_S = 3.0


class Ending(Enum):
    """How a stream ended: at the end of the curves, taken over, ordered to hold, or unable."""

    OVER = "over"
    LEFT = "left"
    HELD = "held"
    UNABLE = "unable"


@dataclass(frozen=True)
class Ended:
    """How and why a stream has ended."""

    how: Ending
    why: str


@dataclass(frozen=True)
class Streamed:
    """What is streamed to one vehicle: its curve as it is now, at the progress of all.

    `progress` is called with the time on the link's clock and may replace the curve.
    """

    mission: VehicleMission
    map: MapFrame
    heading: HeadingPlan | None
    curve: Callable[[], TimedTrajectory]
    progress: Callable[[float], Progress]
    end_s: Callable[[], float]
    tell: Callable[[Event], None]
    settings: GuidedSettings


def fly(context: Context, streamed: Streamed, scheduler: Scheduler) -> Exchange[Ended]:
    """Stream to a vehicle until there is a reason not to, and do what is to be done then.

    At the end of the curves it goes home as missions do. One that cannot go on holds and goes
    home after a while, and everybody is told.
    """
    try:
        frame = yield from ekf_frame(context, streamed.map)
        ended = yield from stream(context, streamed, scheduler, frame)
    except MavlinkError as error:
        ended = Ended(Ending.UNABLE, str(error))
    yield Report(f"streaming ended: {ended.why}")
    if ended.how == Ending.OVER:
        yield from _go_home(context, streamed.mission)
    elif ended.how == Ending.UNABLE:
        text = (
            f"{context.uav} cannot be flown on along its trajectory: {ended.why}. It holds, and "
            f"is called home in {streamed.settings.hold_s:g} s."
        )
        streamed.tell(Event(ERROR, "guided", context.uav, " ".join(text.split())))
        yield from stop(context)
        yield from wait_until(context, context.clock() + streamed.settings.hold_s)
        if context.vehicle.mode in (MODES["BRAKE"], MODES["GUIDED"]):
            yield from return_home(context)
    return ended


def ekf_frame(context: Context, map_frame: MapFrame) -> Exchange[EkfFrame]:
    """Ask a vehicle, armed already, where its local frame and its home are; raises FlightError.

    Arming moves home, so what was heard before does not count.
    """
    vehicle, since_s = context.vehicle, context.clock()
    wanted = (mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN, mavlink.MAVLINK_MSG_ID_HOME_POSITION)
    for message_id in wanted:
        yield from request_message(context, message_id)

    def heard() -> bool:
        return all(vehicle.seen_s.get(message_id, -1.0) >= since_s for message_id in wanted)

    yield from wait_for(context, heard, FRAME_WAIT_S)
    origin, home = vehicle.ekf_origin_deg_m, vehicle.home_deg_m
    if not heard() or origin is None or home is None:
        raise FlightError(601, f"{context.uav}: does not tell the origin of its local frame.")
    return EkfFrame(map_frame, origin, home[2])


def stream(
    context: Context, streamed: Streamed, scheduler: Scheduler, frame: EkfFrame
) -> Exchange[Ended]:
    """Send targets until there is a reason to stop, then stop the vehicle.

    A vehicle that is taken out of GUIDED is its pilot's: it is left alone.
    """
    vehicle, next_s = context.vehicle, context.clock()
    while True:
        now_s = context.clock()
        if vehicle.mode != MODES["GUIDED"] or not vehicle.armed:
            state = vehicle.mode_name if vehicle.armed else "disarmed"
            return Ended(Ending.LEFT, f"it is {state}")
        if scheduler.left:
            return Ended(Ending.LEFT, scheduler.left)
        if scheduler.halted:
            yield from stop(context)
            return Ended(Ending.HELD, scheduler.halted)
        progress = streamed.progress(now_s)
        if progress.elapsed_s > streamed.end_s():
            return Ended(Ending.OVER, "its trajectory has ended")
        here_m = frame.map.position_m(vehicle.lat_deg, vehicle.lon_deg, vehicle.height_m)
        age_s = now_s - vehicle.position_s if vehicle.position_s is not None else float("inf")
        step = scheduler.step(now_s, streamed.curve(), progress, here_m, age_s)
        if step.stop:
            return Ended(Ending.UNABLE, step.stop)
        if step.target is not None:
            facing = None if streamed.heading is None else streamed.heading.at(progress.elapsed_s)
            yield Send(target_message(context, frame, step.target, facing))
        next_s = max(next_s + 1 / streamed.settings.rate_hz, now_s)
        yield from wait_until(context, next_s)


def stop(context: Context) -> Exchange[None]:
    """Bring a vehicle in GUIDED to rest, and see it in BRAKE; raises CommandError."""
    for _ in range(STOPS):
        yield Send(stop_message(context))
        yield from wait_until(context, context.clock() + STOP_EVERY_S)
    if context.vehicle.mode == MODES["GUIDED"]:
        yield from set_mode(context, MODES["BRAKE"])
        yield Report("holds")


def _go_home(context: Context, mission: VehicleMission) -> Exchange[None]:
    """The way home of the mission on board; RTL where the vehicle does not take it."""
    first = homeward_item(mission)
    try:
        yield from send_command(context, mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, (float(first),))
        yield from set_mode(context, MODES["AUTO"])
    except CommandError as error:
        yield Report(f"{error} It returns by RTL.")
        yield from return_home(context)
        return
    yield Report("goes home as its mission ends")


def homeward_item(mission: VehicleMission) -> int:
    """The item of a mission with which the way home begins, after all waiting for others."""
    items = mission.mission.items
    # Behind the last waypoint, or the lift-off of a UAV that has none.
    behind = max(mission.item_map.items, default=1) + 1
    for seq in range(behind, len(items)):
        if items[seq].is_nav and items[seq].command != mavlink.MAV_CMD_NAV_LOITER_TIME:
            return seq
    return len(items) - 1


# The last metres of a climb are slow.
REACHED_SHARE = 0.95
CLIMB_WAIT_S = 60.0


def take_off(context: Context, line: StartLine, height_m: float) -> Exchange[None]:
    """Arm with the others, climb to a height above home and hover; raises MavlinkError.

    If any vehicle of the line fails to arm, the others disarm again.
    """
    vehicle = context.vehicle
    yield from line_up(context, line)
    yield Report("takes off")
    yield from command_seen(
        context,
        mavlink.MAV_CMD_NAV_TAKEOFF,
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, height_m),
        lambda: vehicle.landed_state in AIRBORNE,
        "taking off",
        LIFT_OFF_WAIT_S,
    )
    if not (
        yield from wait_for(
            context, lambda: vehicle.height_m >= REACHED_SHARE * height_m, CLIMB_WAIT_S
        )
    ):
        raise FlightError(
            603, f"{context.uav}: is at {vehicle.height_m:.1f} m, not at {height_m:g} m."
        )
    yield Report(f"hovers at {height_m:g} m")
