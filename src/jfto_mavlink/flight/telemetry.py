"""What vehicles report, as records with the time at which it was true. Knows no ROS."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from jfto_mavlink.dialect import Message, mavlink, mode_name
from jfto_mavlink.flight.follow import FlightTiming, Moment, UnderWay
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.protocol.exchange import Context, Exchange, Wait

STATE_EVERY_S = 0.5
# A vehicle without heartbeats for this long is lost.
LOST_AFTER_S = 5.0
# Why a vehicle has changed its mode stands in texts that it sends just before.
TEXTS_S = 5.0
ON_GROUND = mavlink.MAV_LANDED_STATE_ON_GROUND
# A time stamp further off than this cannot be explained by delay: clocks have jumped.
DELAY_MAX_S = 5.0
UNKNOWN_HEADING = 65535
# GPS time stamps above this are of the Unix epoch, not of the boot.
EPOCH_US = 1_000_000_000_000_000


@dataclass(frozen=True)
class PositionSample:
    """Position and heading; `height_m` is above home.

    In all samples `at_s` is on the link's clock, `utc_ns` as the vehicle has UTC, if it has.
    """

    uav: str
    at_s: float
    utc_ns: int | None
    lat_deg: float
    lon_deg: float
    height_m: float
    yaw_deg: float


@dataclass(frozen=True)
class FixSample:
    """A GPS fix. `altitude_m` is above the ellipsoid, NaN if not told; deviations may be NaN."""

    uav: str
    at_s: float
    utc_ns: int | None
    fixed: bool
    augmented: bool
    lat_deg: float
    lon_deg: float
    altitude_m: float
    horizontal_m: float
    vertical_m: float


@dataclass(frozen=True)
class BatterySample:
    """Voltage, current drawn and share left (0…1); NaN where unknown."""

    uav: str
    at_s: float
    utc_ns: int | None
    voltage_v: float
    current_a: float
    share: float


@dataclass(frozen=True)
class LinkState:
    """How the link and the vehicle are; by default one that was never heard.

    `late_s` is of the last waypoint reached, `ordered` says whether this station ordered the mode,
    `place` is latitude, longitude (degrees) and metres above home. `texts` are the vehicle's
    complaints of the last seconds, `begun` is time zero of its flight.
    """

    uav: str
    at_s: float
    silent_s: float = math.inf
    mode: str = mode_name(None)
    armed: bool = False
    prearm_ok: bool = False
    failsafe: bool = False
    offset_s: float | None = None
    round_trip_s: float | None = None
    jitter_s: float = 0.0
    utc_error_s: float | None = None
    reboots: int = 0
    reached: int = 0
    waypoint_id: int | None = None
    late_s: float | None = None
    landed_state: int | None = None
    fence_breached: bool = False
    ordered: bool = True
    gps_fix: int | None = None
    battery_v: float | None = None
    battery_percent: int | None = None
    place: tuple[float, float, float] = (math.nan,) * 3
    texts: tuple[str, ...] = ()
    begun: Moment | None = None

    @property
    def in_flight(self) -> bool:
        """Whether the vehicle is known to be armed and off the ground."""
        return self.armed and (self.landed_state or ON_GROUND) != ON_GROUND

    @property
    def clock_error_s(self) -> float | None:
        """Bound on how wrong the vehicle's time may be: of stamps, or its UTC against ours."""
        if self.offset_s is None:
            return None
        stamps_s = (self.round_trip_s or 0.0) / 2 + self.jitter_s
        return max(stamps_s, abs(self.utc_error_s or 0.0))


Measurement = PositionSample | FixSample | BatterySample
Sample = Measurement | LinkState


def listen(
    context: Context,
    mission: VehicleMission,
    sink: Callable[[Sample], None],
    under_way: UnderWay | None = None,
    elapsed_s: Callable[[], float | None] | None = None,
) -> Exchange[None]:
    """Hand all that a vehicle reports to `sink`, for ever. Times its route from its lift-off.

    `under_way` tells when a flight began that an earlier run of this program started; a vehicle
    that is in the air when it is first seen is on that flight. `elapsed_s` is as
    `FlightTiming` has it.
    """
    timing = FlightTiming(context, mission, under_way, elapsed_s)
    next_s = context.clock()
    while True:
        now_s = context.clock()
        if now_s >= next_s:
            next_s = now_s + STATE_EVERY_S
            sink(_state(context, timing))
        message = yield Wait(next_s)
        if message is None:
            continue
        timing.take(message)
        decode = _DECODERS.get(message.get_type())
        sample = None if decode is None else decode(context, message)
        if sample is not None:
            sink(sample)


def measured_s(context: Context, boot_s: float) -> float:
    """When a stamp of the vehicle's boot clock was, on ours; now if the clocks are not compared.

    Never in the future: the offset is known to half a round trip only.
    """
    now_s, offset_s = context.clock(), context.vehicle.time_sync.offset_s
    if offset_s is None:
        return now_s
    at_s = min(boot_s - offset_s, now_s)
    return at_s if now_s - at_s <= DELAY_MAX_S else now_s


def _state(context: Context, timing: FlightTiming) -> LinkState:
    vehicle, sync, now_s = context.vehicle, context.vehicle.time_sync, context.clock()
    passed = timing.passed
    return LinkState(
        context.uav,
        now_s,
        vehicle.silent_s(now_s),
        vehicle.mode_name,
        vehicle.armed,
        vehicle.prearm_ok,
        vehicle.system_status == mavlink.MAV_STATE_CRITICAL,
        sync.offset_s,
        sync.round_trip.smoothed_s,
        sync.jitter_s,
        sync.utc_error_s,
        vehicle.reboots,
        len(passed),
        passed[-1].waypoint_id if passed else None,
        passed[-1].late_s if passed else None,
        vehicle.landed_state,
        vehicle.fence_breached,
        vehicle.mode == context.ordered_mode,
        vehicle.gps_fix,
        vehicle.battery_v,
        vehicle.battery_percent,
        (vehicle.lat_deg, vehicle.lon_deg, vehicle.height_m),
        tuple(vehicle.texts_since(now_s - TEXTS_S, mavlink.MAV_SEVERITY_NOTICE)),
        timing.begun,
    )


def _position(context: Context, message: Message) -> PositionSample | None:
    if message.lat == 0 and message.lon == 0:
        # What ArduPilot sends before it knows where it is.
        return None
    yaw_deg = message.hdg / 100
    if message.hdg == UNKNOWN_HEADING:
        yaw_deg = math.degrees(context.vehicle.attitude_rad[2])
    return PositionSample(
        context.uav,
        measured_s(context, message.time_boot_ms / 1e3),
        context.vehicle.utc_ns(message.time_boot_ms / 1e3),
        message.lat / 1e7,
        message.lon / 1e7,
        message.relative_alt / 1e3,
        yaw_deg if math.isfinite(yaw_deg) else 0.0,
    )


def _fix(context: Context, message: Message) -> FixSample:
    stamped = 0 < message.time_usec < EPOCH_US
    own_s = message.time_usec / 1e6 if stamped else context.vehicle.own_time_s(context.clock())
    at_s = measured_s(context, own_s) if stamped else context.clock()
    return FixSample(
        context.uav,
        at_s,
        context.vehicle.utc_ns(own_s),
        message.fix_type >= mavlink.GPS_FIX_TYPE_2D_FIX,
        message.fix_type >= mavlink.GPS_FIX_TYPE_DGPS,
        message.lat / 1e7,
        message.lon / 1e7,
        message.alt_ellipsoid / 1e3 if message.alt_ellipsoid else math.nan,
        message.h_acc / 1e3 if message.h_acc else math.nan,
        message.v_acc / 1e3 if message.v_acc else math.nan,
    )


def _battery(context: Context, message: Message) -> BatterySample:
    voltage, current = message.voltage_battery, message.current_battery
    left = message.battery_remaining
    return BatterySample(
        context.uav,
        context.clock(),
        context.vehicle.utc_ns(context.vehicle.own_time_s(context.clock())),
        math.nan if voltage == 0xFFFF else voltage / 1e3,
        math.nan if current < 0 else current / 100,
        math.nan if left < 0 else left / 100,
    )


_DECODERS: dict[str, Callable[[Context, Message], Sample | None]] = {
    "GLOBAL_POSITION_INT": _position,
    "GPS_RAW_INT": _fix,
    "SYS_STATUS": _battery,
}
