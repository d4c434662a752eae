"""What a vehicle says of itself: at once from what was heard, and aboard when it is asked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import CommandError, MissionError, TransferError
from jfto_mavlink.mission.fence import Fence, fence_from_items
from jfto_mavlink.protocol.command import send_command
from jfto_mavlink.protocol.exchange import Context, Exchange, Send, wait_until
from jfto_mavlink.protocol.item import FENCE
from jfto_mavlink.protocol.parameter import read_parameters
from jfto_mavlink.protocol.setup import ask_version
from jfto_mavlink.protocol.transfer import download
from jfto_mavlink.protocol.vehicle_state import VehicleState
from jfto_msgs_py.retry import Retry

# The autopilot repeats its complaints every 30 s.
PREARM_TEXTS_S = 35.0
# Two vehicles on one link answer within this.
IDENTITY_S = 1.2
Place = tuple[float, float, float]
NAMES = (
    *("FENCE_ENABLE", "FENCE_TYPE", "FENCE_ACTION", "FENCE_ALT_MAX", "FENCE_ALT_MIN"),
    *("FENCE_RADIUS", "FENCE_MARGIN"),
    *("WPNAV_SPEED", "WPNAV_SPEED_UP", "WPNAV_SPEED_DN"),
    *("RTL_ALT", "RTL_ALT_TYPE", "RTL_ALT_FINAL", "RTL_CLIMB_MIN", "RTL_CONE_SLOPE"),
    *("RTL_LOIT_TIME", "RTL_SPEED", "LAND_SPEED", "LAND_SPEED_HIGH", "LAND_ALT_LOW"),
    *("FS_THR_ENABLE", "FS_GCS_ENABLE", "FS_EKF_ACTION", "FS_EKF_THRESH", "FS_OPTIONS"),
    *("BATT_MONITOR", "BATT_CAPACITY", "BATT_LOW_VOLT", "BATT_LOW_MAH", "BATT_FS_LOW_ACT"),
    *("BATT_CRT_VOLT", "BATT_CRT_MAH", "BATT_FS_CRT_ACT", "BRD_SD_MISSION"),
)


@dataclass(frozen=True)
class Snapshot:
    """A vehicle as last heard; None is unknown. `place` is degrees, degrees, m above sea level."""

    silent_s: float
    armed: bool = False
    gps_fix: int | None = None
    satellites: int | None = None
    ekf_ready: bool = False
    fence_breached: bool = False
    prearm_ok: bool = False
    prearm_texts: tuple[str, ...] = ()
    utc_error_s: float | None = None
    place: Place | None = None
    battery_percent: int | None = None
    battery_v: float | None = None
    wind_mps: float | None = None
    signed: bool = False


@dataclass(frozen=True)
class Aboard:
    """What a vehicle answered: `parameters` by their names and in the units of ArduCopter 4.5.

    `unread` says what it did not answer, `differing` how the mission on board is not the plan's.
    """

    parameters: Mapping[str, float] = field(default_factory=dict)
    fence: Fence = field(default_factory=Fence)
    unread: str = ""
    differing: tuple[str, ...] = ()

    def get(self, name: str, default: float = 0.0) -> float:
        """A parameter; the default where the firmware does not know it."""
        return self.parameters.get(name, default)


@dataclass(frozen=True)
class Surveyed:
    """What was found out of one vehicle."""

    now: Snapshot
    aboard: Aboard


def snapshot(vehicle: VehicleState, now_s: float) -> Snapshot:
    """The vehicle as last heard."""
    texts = vehicle.texts_since(now_s - PREARM_TEXTS_S)
    known = vehicle.position_s is not None and vehicle.ekf_ready and not math.isnan(vehicle.alt_m)
    return Snapshot(
        vehicle.silent_s(now_s),
        vehicle.armed,
        vehicle.gps_fix,
        vehicle.satellites,
        vehicle.ekf_ready,
        vehicle.fence_breached,
        vehicle.prearm_ok,
        tuple(text for text in texts if text.startswith(("PreArm:", "Arm:"))),
        vehicle.time_sync.utc_error_s,
        (vehicle.lat_deg, vehicle.lon_deg, vehicle.alt_m) if known else None,
        vehicle.battery_percent,
        vehicle.battery_v,
        vehicle.wind_mps,
        vehicle.signed,
    )


def survey(context: Context, more: tuple[str, ...] = ()) -> Exchange[Aboard]:
    """Ask who it is, for parameters, `more` ones too, for its fence and the wind.

    What does not answer is said in `unread`.
    """
    yield from _ask_who(context)
    try:
        wind = float(mavlink.MAVLINK_MSG_ID_WIND)
        yield from send_command(
            context, mavlink.MAV_CMD_REQUEST_MESSAGE, (wind,), retry=Retry(tries=3)
        )
    except CommandError:
        # Firmware built without it: the wind is then unknown, which the page says.
        context.vehicle.wind_mps = None
    parameters = yield from read_parameters(context, (*NAMES, *more))
    if not parameters:
        return Aboard(unread="no parameter was answered")
    try:
        items = yield from download(context, FENCE)
        return Aboard(parameters, fence_from_items(items))
    except (TransferError, MissionError) as error:
        return Aboard(parameters, unread=f"its fence could not be read: {error}")


def _ask_who(context: Context) -> Exchange[None]:
    """Ask twice: of two vehicles behind one radio both answer, and the station takes note."""
    for _ in range(2):
        yield Send(ask_version(context))
        yield from wait_until(context, context.clock() + IDENTITY_S / 2)
