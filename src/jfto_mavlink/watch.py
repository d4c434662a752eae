"""Changes of a vehicle's state that an operator must learn of, found by comparing."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_mavlink.dialect import mavlink, mode_name
from jfto_mavlink.vehicle import Vehicle

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

    vehicle: Vehicle
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
