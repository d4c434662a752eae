"""Telling one vehicle to start its mission, pause, go on, come home: each command seen to work.

The start: GUIDED, arm, seen armed, MISSION_START, seen flying.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

from jfto_mavlink.dialect import MODES, mavlink
from jfto_mavlink.errors import CommandError, FlightError, MavlinkError
from jfto_mavlink.mission.deliver import Delivered, deliver
from jfto_mavlink.protocol.command import command_seen, send_command, set_mode
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Wait
from jfto_mavlink.protocol.item import Mission
from jfto_mavlink.protocol.transfer import POLICY, TransferPolicy

# The armed bit shows in the next regular heartbeat, up to a second later.
ARMED_WAIT_S = 3.0
# Lift-off comes about 3 s after MISSION_START.
LIFT_OFF_WAIT_S = 6.0
# An armed vehicle on the ground disarms itself after 10 s.
ARM_AHEAD_S = 4.0
# How fast a vehicle's time passes is known after so long.
PACE_OVER_S = 1.0
T = TypeVar("T")
AIRBORNE = (mavlink.MAV_LANDED_STATE_IN_AIR, mavlink.MAV_LANDED_STATE_TAKEOFF)


@dataclass
class StartLine:
    """Shared by vehicles that start together: nobody goes before all first ones are armed.

    `go_s` maps each vehicle to its moment on the link's clock. `failed` names who holds the
    others back, `reason` says why where it is not that it did not arm.
    """

    go_s: dict[str, float]
    armed: set[str] = field(default_factory=set)
    failed: str = ""
    reason: str = ""

    def clear_for(self, uav: str) -> bool:
        """Whether a vehicle may go: everyone whose turn is within its arming time is armed."""
        mine = self.go_s[uav]
        return all(
            other in self.armed for other, at in self.go_s.items() if at <= mine + ARM_AHEAD_S / 2
        )


def start(context: Context, line: StartLine) -> Exchange[float]:
    """Start a mission at the vehicle's moment; returns its own clock when seen flying.

    If any vehicle of the line fails to arm, the others disarm again and raise FlightError 601.
    """
    yield from line_up(context, line)
    yield Report("starts its mission")
    vehicle = context.vehicle
    context.ordered_mode = MODES["AUTO"]
    yield from command_seen(
        context,
        mavlink.MAV_CMD_MISSION_START,
        (),
        lambda: vehicle.mode == MODES["AUTO"] and vehicle.landed_state in AIRBORNE,
        "flying",
        LIFT_OFF_WAIT_S,
    )
    yield Report("flies")
    return vehicle.own_time_s(context.clock())


def line_up(context: Context, line: StartLine) -> Exchange[None]:
    """Arm in GUIDED and wait for the vehicle's moment; raises MavlinkError, disarmed again."""
    pace = _Pace(context)
    try:
        yield from _arm(context, line, pace)
        yield from _wait_for_line(context, line, pace)
    except MavlinkError:
        line.failed = line.failed or context.uav
        yield from disarm(context)
        raise


class _Pace:
    """How much faster than the link's clock a vehicle's own passes: a simulation may be sped up."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._since = self._now()

    def _now(self) -> tuple[float, float]:
        now_s = self._context.clock()
        return now_s, self._context.vehicle.own_time_s(now_s)

    def ahead_s(self) -> float:
        """ARM_AHEAD_S of the vehicle's time, on the link's clock."""
        (now_s, own_s), (since_s, own_since_s) = self._now(), self._since
        if now_s - since_s < PACE_OVER_S:
            return ARM_AHEAD_S
        return ARM_AHEAD_S / max((own_s - own_since_s) / (now_s - since_s), 1.0)


def _arm(context: Context, line: StartLine, pace: _Pace) -> Exchange[None]:
    yield from set_mode(context, MODES["GUIDED"])
    while context.clock() < (arm_s := line.go_s[context.uav] - pace.ahead_s()):
        if line.failed:
            raise _held_back(context, line)
        yield Wait(min(arm_s, context.clock() + PACE_OVER_S))
    yield from command_seen(
        context,
        mavlink.MAV_CMD_COMPONENT_ARM_DISARM,
        (1.0,),
        lambda: context.vehicle.armed,
        "armed",
        ARMED_WAIT_S,
    )
    line.armed.add(context.uav)
    yield Report("armed")


def _wait_for_line(context: Context, line: StartLine, pace: _Pace) -> Exchange[None]:
    go_s = line.go_s[context.uav]
    late_s = go_s + pace.ahead_s()
    while context.clock() < go_s or not line.clear_for(context.uav):
        if line.failed:
            raise _held_back(context, line)
        if context.clock() > late_s:
            line.failed = ", ".join(sorted(set(line.go_s) - line.armed))
            raise _held_back(context, line)
        yield Wait(min(context.clock() + 0.1, late_s + 0.1))
    if not context.vehicle.armed:
        raise FlightError(601, f"{context.uav}: disarmed itself before its turn.")


def _held_back(context: Context, line: StartLine) -> FlightError:
    because = line.reason or f"{line.failed} did not arm"
    return FlightError(601, f"{context.uav}: held back, because {because}.")


def unless_called_off(line: StartLine, exchange: Exchange[T]) -> Exchange[T]:
    """Run an exchange until the line has a `reason`; then end it, raising FlightError 601.

    Nothing is repeated after that: a start under way would undo an order to return.
    """
    answer = None
    while not line.reason:
        try:
            step = exchange.send(answer)
        except StopIteration as stop:
            result: T = stop.value
            return result
        answer = yield step
    exchange.close()
    raise FlightError(601, f"start called off, because {line.reason}.")


def disarm(context: Context) -> Exchange[None]:
    """Disarm on the ground; the vehicle would do it by itself after 10 s."""
    if not context.vehicle.armed:
        return
    try:
        yield from send_command(context, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (0.0,))
    except CommandError as error:
        yield Report(str(error))


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
    context: Context, mission: Mission, first_seq: int = 1, policy: TransferPolicy = POLICY
) -> Exchange[Delivered]:
    """Replace the mission of a flying vehicle and fly the new one from an item on.

    It holds in BRAKE meanwhile, since in AUTO each stored item restarts the leg and half a mission
    could fly. The current item must be set: the autopilot keeps the old number. After an error it
    goes on holding; the error says which mission is on board.
    """
    was_auto = context.vehicle.mode == MODES["AUTO"]
    if was_auto:
        yield from brake(context)
    delivered = yield from deliver(context, mission, policy)
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
