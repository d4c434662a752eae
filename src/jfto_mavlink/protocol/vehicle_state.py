"""One vehicle as last heard: what its messages say, and nothing else."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from jfto_mavlink.dialect import Message, mavlink, mode_name
from jfto_mavlink.io.framing import MAGIC_V2, SIGNED
from jfto_mavlink.protocol.timesync import TimeSync

TEXTS_KEPT = 200
# A clock that goes back by more than this is a reboot, by less an old datagram.
REBOOT_BACKSTEP_MS = 2000
# Our clock carries the vehicle's on for at most this long.
OWN_TIME_AHEAD_S = 0.2

EKF_READY = (
    mavlink.EKF_ATTITUDE
    | mavlink.EKF_VELOCITY_HORIZ
    | mavlink.EKF_VELOCITY_VERT
    | mavlink.EKF_POS_HORIZ_ABS
    | mavlink.EKF_POS_VERT_ABS
)
PREARM_HEALTHY = mavlink.MAV_SYS_STATUS_PREARM_CHECK
FENCE_SENSOR = mavlink.MAV_SYS_STATUS_GEOFENCE


@dataclass(frozen=True)
class StatusText:
    """A text from the vehicle; severity 0 (emergency) to 7 (debug)."""

    at_s: float
    severity: int
    text: str


@dataclass
class VehicleState:
    """State of one vehicle. Times are those of the clock given to `update`.

    `seen_s` is when each message id was last heard, `utc_at_boot_us` what the vehicle takes for UTC
    at the zero of its own clock. `newer_names` says that its parameters have the names and units of
    ArduCopter 4.7, `signed` that its last heartbeat was. `wind_mps` is None while it has told none.
    """

    uav: str
    heard_s: float | None = None
    heartbeat_s: float | None = None
    mode: int | None = None
    armed: bool = False
    system_status: int | None = None
    time_boot_ms: int | None = None
    boot_time_heard_s: float = 0.0
    utc_at_boot_us: int | None = None
    reboots: int = 0
    lat_deg: float = math.nan
    lon_deg: float = math.nan
    alt_m: float = math.nan
    height_m: float = math.nan
    velocity_ned_mps: tuple[float, float, float] = (math.nan,) * 3
    position_s: float | None = None
    attitude_rad: tuple[float, float, float] = (math.nan,) * 3
    gps_fix: int | None = None
    satellites: int | None = None
    ekf_flags: int | None = None
    battery_v: float | None = None
    battery_percent: int | None = None
    wind_mps: float | None = None
    newer_names: bool = False
    signed: bool = False
    sensors_enabled: int = 0
    sensors_health: int | None = None
    mission_current: int | None = None
    mission_state: int | None = None
    landed_state: int | None = None
    home_deg_m: tuple[float, float, float] | None = None
    ekf_origin_deg_m: tuple[float, float, float] | None = None
    uid: str | None = None
    texts: deque[StatusText] = field(default_factory=lambda: deque(maxlen=TEXTS_KEPT))
    time_sync: TimeSync = field(default_factory=TimeSync)
    seen_s: dict[int, float] = field(default_factory=dict)
    _partial_text: tuple[int, str] = (0, "")

    def update(self, message: Message, now_s: float) -> None:
        """Take in a message of the vehicle's autopilot."""
        self.heard_s = now_s
        self.seen_s[message.get_msgId()] = now_s
        handler = _HANDLERS.get(message.get_type())
        if handler is not None:
            handler(self, message, now_s)

    @property
    def mode_name(self) -> str:
        """Name of the flight mode."""
        return mode_name(self.mode)

    @property
    def prearm_ok(self) -> bool:
        """Whether the autopilot says that all its checks before arming pass."""
        return bool((self.sensors_health or 0) & PREARM_HEALTHY)

    @property
    def fence_breached(self) -> bool:
        """Whether an enabled fence reports a breach."""
        return bool(
            self.sensors_enabled & FENCE_SENSOR
            and self.sensors_health is not None
            and not self.sensors_health & FENCE_SENSOR
        )

    @property
    def in_flight(self) -> bool:
        """Whether it is armed and not known to stand on the ground."""
        return self.armed and self.landed_state != mavlink.MAV_LANDED_STATE_ON_GROUND

    @property
    def ekf_ready(self) -> bool:
        """Whether the position estimate is good enough for AUTO."""
        return self.ekf_flags is not None and self.ekf_flags & EKF_READY == EKF_READY

    def texts_since(self, since_s: float, worst: int = mavlink.MAV_SEVERITY_WARNING) -> list[str]:
        """Texts of that severity or worse heard from a time on, oldest first, each once."""
        found = [t.text for t in self.texts if t.at_s >= since_s and t.severity <= worst]
        return list(dict.fromkeys(found))

    def own_time_s(self, now_s: float) -> float:
        """Seconds on the vehicle's own clock now, from its last message and a little of ours.

        A sped-up simulation on a busy computer keeps its own time, and missions are timed by it.
        """
        if self.time_boot_ms is None:
            return now_s
        return self.time_boot_ms / 1000 + min(now_s - self.boot_time_heard_s, OWN_TIME_AHEAD_S)

    def utc_ns(self, boot_s: float) -> int | None:
        """UTC as the vehicle has it at a time of its own clock; None while it has told none."""
        if self.utc_at_boot_us is None:
            return None
        return self.utc_at_boot_us * 1000 + round(boot_s * 1e9)

    def boot_s(self, utc_ns: int) -> float | None:
        """The vehicle's own clock at a time in UTC as it has it; None while it has told none."""
        if self.utc_at_boot_us is None:
            return None
        return (utc_ns - self.utc_at_boot_us * 1000) / 1e9

    def silent_s(self, now_s: float) -> float:
        """Seconds without a heartbeat; infinite if there never was one."""
        return math.inf if self.heartbeat_s is None else now_s - self.heartbeat_s

    def booted(self) -> None:
        """Forget what a restart of the vehicle makes untrue."""
        self.reboots += 1
        self.time_boot_ms = self.utc_at_boot_us = None
        self.time_sync.restart()
        self.uid = None
        self.mission_current = None
        self.home_deg_m = self.ekf_origin_deg_m = None

    def _at_boot_time(self, time_boot_ms: int, now_s: float) -> None:
        last = self.time_boot_ms
        if last is not None and time_boot_ms + REBOOT_BACKSTEP_MS < last:
            self.booted()
        self.time_boot_ms = time_boot_ms
        self.boot_time_heard_s = now_s


def _heartbeat(vehicle: VehicleState, message: Message, now_s: float) -> None:
    vehicle.heartbeat_s = now_s
    vehicle.mode = message.custom_mode
    vehicle.armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
    vehicle.system_status = message.system_status
    frame = message.get_msgbuf()
    vehicle.signed = bool(frame and frame[0] == MAGIC_V2 and frame[2] & SIGNED)


def _position(vehicle: VehicleState, message: Message, now_s: float) -> None:
    vehicle._at_boot_time(message.time_boot_ms, now_s)
    vehicle.lat_deg, vehicle.lon_deg = message.lat / 1e7, message.lon / 1e7
    vehicle.alt_m, vehicle.height_m = message.alt / 1e3, message.relative_alt / 1e3
    vehicle.velocity_ned_mps = (message.vx / 100, message.vy / 100, message.vz / 100)
    vehicle.position_s = now_s


def _attitude(vehicle: VehicleState, message: Message, now_s: float) -> None:
    vehicle._at_boot_time(message.time_boot_ms, now_s)
    vehicle.attitude_rad = (message.roll, message.pitch, message.yaw)


def _system_time(vehicle: VehicleState, message: Message, now_s: float) -> None:
    vehicle._at_boot_time(message.time_boot_ms, now_s)
    if message.time_unix_usec:
        vehicle.utc_at_boot_us = message.time_unix_usec - message.time_boot_ms * 1000


def _gps(vehicle: VehicleState, message: Message, _: float) -> None:
    vehicle.gps_fix, vehicle.satellites = message.fix_type, message.satellites_visible


def _ekf(vehicle: VehicleState, message: Message, _: float) -> None:
    vehicle.ekf_flags = message.flags


def _sys_status(vehicle: VehicleState, message: Message, _: float) -> None:
    vehicle.sensors_enabled = message.onboard_control_sensors_enabled
    vehicle.sensors_health = message.onboard_control_sensors_health
    known = message.voltage_battery != 0xFFFF
    vehicle.battery_v = message.voltage_battery / 1000 if known else None
    known = message.battery_remaining >= 0
    vehicle.battery_percent = message.battery_remaining if known else None


def _wind(vehicle: VehicleState, message: Message, _: float) -> None:
    # A copter that has no estimate of the wind says 0 of it.
    vehicle.wind_mps = message.speed or None


def _mission_current(vehicle: VehicleState, message: Message, _: float) -> None:
    vehicle.mission_current, vehicle.mission_state = message.seq, message.mission_state


def _extended_state(vehicle: VehicleState, message: Message, _: float) -> None:
    vehicle.landed_state = message.landed_state


def _home(vehicle: VehicleState, message: Message, _: float) -> None:
    vehicle.home_deg_m = (message.latitude / 1e7, message.longitude / 1e7, message.altitude / 1e3)


def _ekf_origin(vehicle: VehicleState, message: Message, _: float) -> None:
    place = (message.latitude / 1e7, message.longitude / 1e7, message.altitude / 1e3)
    vehicle.ekf_origin_deg_m = place


def _version(vehicle: VehicleState, message: Message, _: float) -> None:
    vehicle.uid = uid_text(message)


def _status_text(vehicle: VehicleState, message: Message, now_s: float) -> None:
    text, chunk_id = message.text, message.id
    if chunk_id:
        # Long texts come in pieces of 50 characters under one id; the last is shorter.
        previous_id, begun = vehicle._partial_text
        text = (begun if previous_id == chunk_id and message.chunk_seq else "") + text
        if len(message.text) == 50:
            vehicle._partial_text = (chunk_id, text)
            return
        vehicle._partial_text = (0, "")
    vehicle.texts.append(StatusText(now_s, message.severity, text))


def uid_text(message: Message) -> str:
    """Identity in an AUTOPILOT_VERSION: uid2 in hexadecimal, else uid, "" if it has none."""
    uid2 = bytes(message.uid2).rstrip(b"\0")
    if uid2:
        return uid2.hex()
    return f"{message.uid:016x}" if message.uid else ""


_HANDLERS: dict[str, Callable[[VehicleState, Message, float], None]] = {
    "HEARTBEAT": _heartbeat,
    "GLOBAL_POSITION_INT": _position,
    "ATTITUDE": _attitude,
    "SYSTEM_TIME": _system_time,
    "GPS_RAW_INT": _gps,
    "EKF_STATUS_REPORT": _ekf,
    "SYS_STATUS": _sys_status,
    "WIND": _wind,
    "MISSION_CURRENT": _mission_current,
    "EXTENDED_SYS_STATE": _extended_state,
    "HOME_POSITION": _home,
    "GPS_GLOBAL_ORIGIN": _ekf_origin,
    "AUTOPILOT_VERSION": _version,
    "STATUSTEXT": _status_text,
}
