"""A three-cell battery whose voltage SIM_BATT_VOLTAGE sets, and the failsafes that watch it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from jfto_sim.parameters import Parameters

FLYING_A, IDLE_ARMED_A = 28.5, 1.5


class BatteryState(IntEnum):
    """Worst condition latched so far; it never gets better before a restart."""

    HEALTHY = 0
    LOW = 1
    CRITICAL = 2


@dataclass
class Battery:
    """Voltage now, charge used, and how long the voltage has been too low."""

    params: Parameters
    consumed_mah: float = 0.0
    consumed_wh: float = 0.0
    current_a: float = 0.0
    state: BatteryState = BatteryState.HEALTHY
    low_since_s: float | None = None
    critical_since_s: float | None = None

    @property
    def voltage_v(self) -> float:
        """Voltage at the terminals."""
        return self.params["SIM_BATT_VOLTAGE"]

    @property
    def remaining_percent(self) -> int:
        """Charge left by consumption."""
        used = 100.0 * self.consumed_mah / max(self.params["BATT_CAPACITY"], 1.0)
        return max(0, int(100.0 - used))

    def draw(self, *, armed: bool, flying: bool, dt_s: float) -> None:
        """Use charge for one step."""
        self.current_a = FLYING_A if flying else IDLE_ARMED_A if armed else 0.0
        self.consumed_mah += self.current_a * dt_s / 3.6
        self.consumed_wh += self.current_a * self.voltage_v * dt_s / 3600.0

    def worsened(self, now_s: float) -> BatteryState | None:
        """The new state if the voltage has been below a threshold for BATT_LOW_TIMER seconds."""
        timer_s = self.params["BATT_LOW_TIMER"]
        self.critical_since_s = self._since(self.critical_since_s, "BATT_CRT_VOLT", now_s)
        self.low_since_s = self._since(self.low_since_s, "BATT_LOW_VOLT", now_s)
        found = BatteryState.HEALTHY
        if self.low_since_s is not None and now_s - self.low_since_s >= timer_s:
            found = BatteryState.LOW
        if self.critical_since_s is not None and now_s - self.critical_since_s >= timer_s:
            found = BatteryState.CRITICAL
        if found <= self.state:
            return None
        self.state = found
        return found

    def _since(self, before_s: float | None, threshold: str, now_s: float) -> float | None:
        limit = self.params[threshold]
        if limit <= 0 or self.voltage_v >= limit:
            return None
        return now_s if before_s is None else before_s
