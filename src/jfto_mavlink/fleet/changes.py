"""Changes of a vehicle's state that an operator must learn of, found by comparing."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_mavlink.dialect import mavlink, mode_name
from jfto_mavlink.flight.telemetry import LinkState
from jfto_mavlink.protocol.vehicle_state import VehicleState
from jfto_msgs_py.ros.events import ERROR, INFO, WARN

LOST_AFTER_S = 5.0
LANDED = {1: "on the ground", 2: "in the air", 3: "taking off", 4: "landing"}


@dataclass(frozen=True)
class Event:
    """Something that happened to a vehicle. `kind` is a word for programs, `text` for people."""

    at_s: float
    uav: str
    kind: str
    text: str


@dataclass
class Watch:
    """Remembers what was last told about one vehicle."""

    vehicle: VehicleState
    lost_after_s: float = LOST_AFTER_S
    battery_low_percent: int = 25
    _told: tuple[object, ...] = ()
    _lost: bool = True
    _low: bool = False

    def look(self, now_s: float) -> list[Event]:
        """Events since the last look, oldest first."""
        vehicle = self.vehicle
        found: list[tuple[str, str]] = []
        lost = vehicle.silent_s(now_s) > self.lost_after_s
        if lost != self._lost:
            self._lost = lost
            found.append(("link_lost", "link lost") if lost else ("link", "heard"))
        found += self._state_changes()
        percent = vehicle.battery_percent
        if percent is not None and (percent < self.battery_low_percent) != self._low:
            self._low = not self._low
            found.append(("battery_low" if self._low else "battery", f"battery {percent} %"))
        return [Event(now_s, vehicle.uav, kind, text) for kind, text in found]

    @property
    def lost(self) -> bool:
        """Whether the vehicle is silent."""
        return self._lost

    def _state_changes(self) -> list[tuple[str, str]]:
        vehicle = self.vehicle
        failsafe = vehicle.system_status == mavlink.MAV_STATE_CRITICAL
        now = (
            vehicle.mode,
            vehicle.armed,
            vehicle.landed_state,
            failsafe,
            vehicle.fence_breached,
            vehicle.reboots,
        )
        before = self._told or (None, False, None, False, False, 0)
        self._told = now
        words = (
            ("mode", f"mode {mode_name(vehicle.mode)}"),
            ("armed", "armed" if vehicle.armed else "disarmed"),
            ("landed", LANDED.get(vehicle.landed_state or 0, "unknown")),
            ("failsafe", "failsafe" if failsafe else "failsafe over"),
            ("fence", "fence breached" if vehicle.fence_breached else "inside the fence"),
            ("reboot", "booted again"),
        )
        return [word for word, old, new in zip(words, before, now, strict=True) if old != new]


GPS_FIX_3D = 3
BATTERY_LOW_PERCENT = 25
# How a vehicle's text begins, the kind of the event, and what to call it.
_CAUSES = (
    ("Battery 1 is", "battery", ""),
    ("EKF Failsafe", "gps", "has lost its position"),
    ("GCS Failsafe", "link", "has lost its station"),
    ("Fence Breached", "fence", "has left its fence"),
    ("Failsafe: Terrain", "failsafe", "has no terrain data"),
)
_DOES = {
    "RTL": "returns home",
    "SMART_RTL": "returns home",
    "LAND": "lands where it is",
    "AUTO": "flies its mission again",
}
LEAVING = ("RTL", "SMART_RTL", "LAND")


@dataclass(frozen=True)
class Notice:
    """One line for the operator, as an event says it; `uav` "" means the fleet."""

    level: int
    kind: str
    uav: str
    text: str


def changes(before: LinkState, now: LinkState) -> list[Notice]:
    """What has changed in flight between two states, except who is heard and who has landed."""
    found = [*_mode(before, now), *_gps(before, now), *_battery(before, now)]
    if now.reboots > before.reboots:
        text = "booted again in the air; nothing can be ordered until it is ready"
        found.append(Notice(ERROR, "vehicle", now.uav, f"{now.uav} {text}"))
    return found


def place_text(state: LinkState) -> str:
    """Where a vehicle was last heard to be."""
    lat_deg, lon_deg, height_m = state.place
    return f"{lat_deg:.6f} {lon_deg:.6f}, {height_m:.0f} m above its pad"


def _mode(before: LinkState, now: LinkState) -> list[Notice]:
    if now.mode == before.mode or now.ordered:
        return []
    kind, reason = _cause(now)
    does = _DOES.get(now.mode, f"is in {now.mode}; order abort to bring it home")
    where = f" at {place_text(now)}" if now.mode == "LAND" else ""
    text = f"{now.uav} {reason}: by itself it {does}{where}"
    return [Notice(WARN if now.mode == "AUTO" else ERROR, kind, now.uav, text)]


def _cause(state: LinkState) -> tuple[str, str]:
    for start, kind, words in _CAUSES:
        for text in reversed(state.texts):
            if text.startswith(start):
                # "Battery 1 is low 10.20V used 471 mAh"
                return kind, words or f"says {text[0].lower()}{text[1:]}"
    return "mode", "changed its mode, which nobody ordered here"


def _gps(before: LinkState, now: LinkState) -> list[Notice]:
    if before.gps_fix is None or now.gps_fix is None:
        return []
    had, has = before.gps_fix >= GPS_FIX_3D, now.gps_fix >= GPS_FIX_3D
    if had == has:
        return []
    if has:
        return [Notice(INFO, "gps", now.uav, f"{now.uav} has its GPS back, in {now.mode}")]
    text = f"has lost its GPS: it flies on in {now.mode} until its own failsafe lands it"
    return [Notice(ERROR, "gps", now.uav, f"{now.uav} {text}")]


def _battery(before: LinkState, now: LinkState) -> list[Notice]:
    found = []
    told = [text for text in before.texts if text.startswith("Battery 1 is")]
    fresh = [text for text in told if text not in now.texts]
    if fresh and now.mode not in LEAVING:
        # Said long enough ago: its failsafe would have acted by now.
        text = f"says {fresh[-1]}, and no failsafe has acted: it flies on in {now.mode}"
        found.append(Notice(ERROR, "battery", now.uav, f"{now.uav} {text}"))
    if before.battery_percent is not None and now.battery_percent is not None:
        low, was = (p < BATTERY_LOW_PERCENT for p in (now.battery_percent, before.battery_percent))
        if low and not was:
            text = f"{now.uav} has {now.battery_percent} % of its battery left and flies on"
            found.append(Notice(WARN, "battery", now.uav, text))
    return found
