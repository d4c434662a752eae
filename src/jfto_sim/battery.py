"""A three-cell battery: what it gives, what is left of it, and the limits that are set for it.

SIM_BATT_VOLTAGE is its voltage, whatever is drawn, as in ArduPilot's simulation. With
SIM_BATT_CAP_AH above 0 it is the voltage of a full one, which falls as the charge is used and sags
under load.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from jfto_sim.parameters import Parameters

# Hovering at 12.6 V, as recorded; current goes with thrust, and power with current times voltage.
HOVER_A, HOVER_V, IDLE_ARMED_A = 28.1, 12.6, 1.5
_RESISTANCE_OHM = 0.01
# Share of the full voltage by the share of charge that is left: a lithium polymer cell.
_CHARGE = (0.0, 0.02, 0.04, 0.08, 0.15, 0.23, 0.31, 0.42, 0.5, 0.62, 0.77, 0.88, 1.0)
_VOLTAGE = (0.2, 0.71, 0.74, 0.76, 0.79, 0.83, 0.85, 0.88, 0.9, 0.92, 0.945, 0.976, 1.0)


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
        full_v, capacity_ah = self.params["SIM_BATT_VOLTAGE"], self.params["SIM_BATT_CAP_AH"]
        if capacity_ah <= 0:
            return full_v
        left = max(0.0, 1.0 - 1e-3 * self.consumed_mah / capacity_ah)
        rest_v = full_v * float(np.interp(left, _CHARGE, _VOLTAGE))
        return max(0.0, rest_v - _RESISTANCE_OHM * self.current_a)

    @property
    def remaining_percent(self) -> int:
        """Charge left by consumption."""
        used = 100.0 * self.consumed_mah / max(self.params["BATT_CAPACITY"], 1.0)
        return max(0, int(100.0 - used))

    def draw(self, *, armed: bool, thrust: float, dt_s: float) -> None:
        """Use charge for one step; `thrust` is in weights of the vehicle, 0 on the ground."""
        flying_a = HOVER_A * thrust * HOVER_V / max(self.voltage_v, 1.0)
        self.current_a = flying_a if thrust > 0 else IDLE_ARMED_A if armed else 0.0
        self.consumed_mah += self.current_a * dt_s / 3.6
        self.consumed_wh += self.current_a * self.voltage_v * dt_s / 3600.0

    # --- limits ---

    def worsened(self, now_s: float) -> BatteryState | None:
        """The new state where a voltage limit was passed for BATT_LOW_TIMER seconds, or a charge
        limit at all.
        """
        timer_s = self.params["BATT_LOW_TIMER"]
        self.critical_since_s = self._since(self.critical_since_s, "BATT_CRT_VOLT", now_s)
        self.low_since_s = self._since(self.low_since_s, "BATT_LOW_VOLT", now_s)
        found = BatteryState.HEALTHY
        for state, since_s, charge in (
            (BatteryState.LOW, self.low_since_s, "BATT_LOW_MAH"),
            (BatteryState.CRITICAL, self.critical_since_s, "BATT_CRT_MAH"),
        ):
            too_long = since_s is not None and 0 < timer_s <= now_s - since_s
            if too_long or self._short_of(charge):
                found = state
        if found <= self.state:
            return None
        self.state = found
        return found

    def _since(self, before_s: float | None, threshold: str, now_s: float) -> float | None:
        if not self._below(threshold):
            return None
        return now_s if before_s is None else before_s

    def _below(self, threshold: str) -> bool:
        return self.params[threshold] > 0 and self.voltage_v < self.params[threshold]

    def _short_of(self, threshold: str) -> bool:
        wanted_mah = self.params[threshold]
        return wanted_mah > 0 and self.params["BATT_CAPACITY"] - self.consumed_mah < wanted_mah

    def fault(self) -> str:
        """Why nobody should take off with it, in the autopilot's words; empty if one may."""
        p = self.params
        low_v, critical_v = p["BATT_LOW_VOLT"], p["BATT_CRT_VOLT"]
        low_mah, critical_mah = p["BATT_LOW_MAH"], p["BATT_CRT_MAH"]
        wrong = (
            (self._below("BATT_ARM_VOLT"), "below minimum arming voltage"),
            (self._short_of("BATT_ARM_MAH"), "below minimum arming capacity"),
            (self._below("BATT_LOW_VOLT"), "low voltage failsafe"),
            (self._short_of("BATT_LOW_MAH"), "low capacity failsafe"),
            (self._below("BATT_CRT_VOLT"), "critical voltage failsafe"),
            (self._short_of("BATT_CRT_MAH"), "critical capacity failsafe"),
            (0 < low_mah <= critical_mah, "capacity failsafe critical >= low"),
            (0 < low_v <= critical_v, "voltage failsafe critical >= low"),
        )
        return next((text for is_so, text in wrong if is_so), "")
