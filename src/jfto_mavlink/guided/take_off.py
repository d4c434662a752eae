"""From the pad to a hover in GUIDED."""

from __future__ import annotations

from jfto_mavlink.command import command_seen
from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import FlightError
from jfto_mavlink.exchange import Context, Exchange, Report, wait_for
from jfto_mavlink.flight.start import AIRBORNE, LIFT_OFF_WAIT_S, StartLine, line_up

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
