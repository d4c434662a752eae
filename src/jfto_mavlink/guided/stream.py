"""GUIDED flight of one vehicle: from the pad to a hover, a stream of targets, a deliberate end."""

from __future__ import annotations

from collections.abc import Callable

from jfto_mavlink.dialect import MODES, mavlink
from jfto_mavlink.errors import FlightError
from jfto_mavlink.flight.control import AIRBORNE, LIFT_OFF_WAIT_S, StartLine, line_up
from jfto_mavlink.guided.scheduler import Scheduler
from jfto_mavlink.guided.target import EkfFrame, HeadingPlan, MapFrame, stop_message, target_message
from jfto_mavlink.protocol.command import command_seen, request_message, set_mode
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Send, wait_for, wait_until

# Zero velocities sent before BRAKE is asked for: one may be lost.
STOPS = 3
STOP_EVERY_S = 0.05
FRAME_WAIT_S = 3.0


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
    context: Context,
    scheduler: Scheduler,
    frame: EkfFrame,
    heading: HeadingPlan | None,
    start_ns: Callable[[], int],
    now_ns: Callable[[], int],
    rate_hz: float = 10.0,
) -> Exchange[str]:
    """Send targets until there is a reason to stop, then stop the vehicle; returns the reason.

    A vehicle that is taken out of GUIDED is its pilot's: it is left alone. `start_ns` is lift-off
    of the trajectory, `now_ns` the time that it is in.
    """
    vehicle, next_s = context.vehicle, context.clock()
    while True:
        now_s = context.clock()
        if vehicle.mode != MODES["GUIDED"] or not vehicle.armed:
            state = vehicle.mode_name if vehicle.armed else "disarmed"
            yield Report(f"is {state}, streaming ended")
            return f"it is {state}"
        here_m = frame.map.position_m(vehicle.lat_deg, vehicle.lon_deg, vehicle.height_m)
        age_s = now_s - vehicle.position_s if vehicle.position_s is not None else float("inf")
        at_ns = now_ns()
        step = scheduler.step(now_s, at_ns, here_m, age_s)
        if step.stop:
            yield Report(f"streaming ends: {step.stop}")
            if not step.leave:
                yield from stop(context)
            return step.stop
        if step.target is not None:
            facing = None if heading is None else heading.at((at_ns - start_ns()) / 1e9)
            yield Send(target_message(context, frame, step.target, facing))
        next_s = max(next_s + 1 / rate_hz, now_s)
        yield from wait_until(context, next_s)


def stop(context: Context) -> Exchange[None]:
    """Bring a vehicle in GUIDED to rest, and see it in BRAKE; raises CommandError."""
    for _ in range(STOPS):
        yield Send(stop_message(context))
        yield from wait_until(context, context.clock() + STOP_EVERY_S)
    if context.vehicle.mode == MODES["GUIDED"]:
        yield from set_mode(context, MODES["BRAKE"])
        yield Report("holds")


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
