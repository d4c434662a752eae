"""The gate before arming: everything that must be right, said in words when it is not."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import CommandError, TransferError
from jfto_mavlink.mission.deliver import verify
from jfto_mavlink.protocol.command import send_command
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Wait
from jfto_mavlink.protocol.item import Mission, distance_m
from jfto_mavlink.protocol.vehicle_state import VehicleState
from jfto_msgs_py.retry import Retry

# The autopilot repeats its complaints every 30 s.
PREARM_TEXTS_S = 35.0
CHECKS_EVERY_S = 5.0


@dataclass(frozen=True)
class GateSettings:
    """What a vehicle must show before it may be armed.

    `utc_error_max_s` is a quarter of a slot when the plan is held by the clock, None to leave the
    clock out. `wait_s` is how long a vehicle may take to become ready.
    """

    battery_min_percent: int = 50
    gps_fix_min: int = 3
    satellites_min: int = 6
    pad_distance_max_m: float = 15.0
    silent_max_s: float = 3.0
    utc_error_max_s: float | None = None
    wait_s: float = 90.0


def problems(
    vehicle: VehicleState,
    now_s: float,
    home_deg: tuple[float, float] | None,
    settings: GateSettings,
) -> tuple[str, ...]:
    """Everything that speaks against arming, without asking the vehicle anything."""
    found = []
    if vehicle.silent_s(now_s) > settings.silent_max_s:
        found.append(f"no heartbeat for {vehicle.silent_s(now_s):.0f} s")
    if vehicle.armed:
        found.append("is armed already")
    if (vehicle.gps_fix or 0) < settings.gps_fix_min:
        found.append(f"GPS fix is {vehicle.gps_fix}, needs {settings.gps_fix_min}")
    if (vehicle.satellites or 0) < settings.satellites_min:
        found.append(f"{vehicle.satellites} satellites, needs {settings.satellites_min}")
    if not vehicle.ekf_ready:
        found.append("position estimate is not ready")
    percent = vehicle.battery_percent
    if percent is not None and percent < settings.battery_min_percent:
        found.append(f"battery at {percent} %, needs {settings.battery_min_percent} %")
    if vehicle.fence_breached:
        found.append("is outside its fence")
    if not vehicle.prearm_ok:
        texts = [
            t
            for t in vehicle.texts_since(now_s - PREARM_TEXTS_S)
            if t.startswith(("PreArm:", "Arm:"))
        ]
        found.append(" ".join(f'"{t}"' for t in texts) or "checks of the autopilot do not pass")
    if home_deg is not None and vehicle.ekf_ready and vehicle.position_s is not None:
        away = distance_m((vehicle.lat_deg, vehicle.lon_deg, 0.0), (*home_deg, 0.0))
        if away > settings.pad_distance_max_m:
            found.append(f"stands {away:.0f} m from its planned pad")
    error_s = vehicle.time_sync.utc_error_s
    limit_s = settings.utc_error_max_s
    if limit_s is not None and (error_s is None or abs(error_s) > limit_s):
        clock = "unknown" if error_s is None else f"{error_s:+.2f} s off"
        found.append(f"its clock is {clock}, a quarter slot is {limit_s:.2f} s")
    return tuple(found)


def gate(
    context: Context,
    mission: Mission,
    home_deg: tuple[float, float] | None,
    settings: GateSettings,
) -> Exchange[tuple[str, ...]]:
    """Wait until nothing speaks against arming, then read the mission back once more.

    Returns what remains, in words; empty if the vehicle may fly.
    """
    found = yield from wait_ready(context, home_deg, settings)
    if found:
        return found
    try:
        differing = yield from verify(context, mission)
    except TransferError as error:
        return (str(error),)
    return tuple(f"{context.uav}: mission on board: {text}" for text in differing)


def wait_ready(
    context: Context, home_deg: tuple[float, float] | None, settings: GateSettings
) -> Exchange[tuple[str, ...]]:
    """Wait until nothing speaks against arming; returns what still does, in words."""
    until_s = context.clock() + settings.wait_s
    ask_s = context.clock()
    told: tuple[str, ...] = ()
    while found := problems(context.vehicle, context.clock(), home_deg, settings):
        now_s = context.clock()
        if now_s >= until_s:
            return tuple(f"{context.uav}: {problem}" for problem in found)
        if now_s >= ask_s:
            ask_s = now_s + CHECKS_EVERY_S
            if found != told:
                yield Report(f"not ready: {'; '.join(found)}")
            told = found
            yield from _ask_for_checks(context)
        yield Wait(min(until_s, ask_s))
    return ()


def _ask_for_checks(context: Context) -> Exchange[None]:
    """Let the autopilot say what it misses; its texts follow by themselves."""
    try:
        yield from send_command(context, mavlink.MAV_CMD_RUN_PREARM_CHECKS, retry=Retry(tries=2))
    except CommandError as error:
        # Refused while armed, which is reported anyway.
        yield Report(str(error))
