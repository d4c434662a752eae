"""Station, battery, EKF and fence failsafes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jfto_sim.battery import BatteryState
from jfto_sim.dialect import CRITICAL, EMERGENCY, NOTICE, WARNING
from jfto_sim.estimator import RECOVERED_AFTER_S, STOPPED_AIDING_AFTER_S, VARIANCE_AFTER_S
from jfto_sim.fence import breach
from jfto_sim.modes.numbers import NEEDS_POSITION, Mode

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

CONTINUE_IN_AUTO = 2  # bit of FS_OPTIONS
_BATTERY_ACTION = {1: Mode.LAND, 2: Mode.RTL, 3: Mode.RTL, 4: Mode.RTL, 7: Mode.BRAKE}
_FENCE_ACTION = {1: Mode.RTL, 2: Mode.LAND, 3: Mode.RTL, 4: Mode.BRAKE, 5: Mode.RTL}
_THRUST_LOSS_AFTER_S = 3.9


class Failsafes:
    """Watches what can go wrong; `critical` is what HEARTBEAT shows as system status 5."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.station_heard_s: float | None = None
        self.station = False
        self.ekf = False
        self._ekf_acted = False
        self._lane_switched = False
        self.fence_breach = 0
        self.fence_count = 0
        self.fence_time_s = 0.0
        self._thrust_told = False

    @property
    def critical(self) -> bool:
        """Whether a failsafe is in force."""
        return self.station or self.ekf or self.vehicle.battery.state > BatteryState.HEALTHY

    def station_heard(self) -> None:
        """A heartbeat of SYSID_MYGCS arrived."""
        self.station_heard_s = self.vehicle.time_s
        if self.station:
            self.station = False
            self.vehicle.text(WARNING, "GCS Failsafe Cleared")

    def tick(self) -> None:
        """Look at everything once; called ten times a second."""
        self._watch_battery()
        self._watch_ekf()
        self._watch_station()
        self._watch_fence()
        self._watch_thrust()

    def _watch_station(self) -> None:
        v = self.vehicle
        action = int(v.params["FS_GCS_ENABLE"])
        if action == 0 or self.station_heard_s is None or self.station:
            return
        if v.time_s - self.station_heard_s < v.params["FS_GCS_TIMEOUT"]:
            return
        self.station = True
        if not v.arming.armed:
            return
        if v.mode.number == Mode.AUTO and int(v.params["FS_OPTIONS"]) & CONTINUE_IN_AUTO:
            v.text(WARNING, "GCS Failsafe - Continuing Auto Mode")
            return
        v.text(WARNING, "GCS Failsafe")
        self._go(Mode.LAND if action == 5 else Mode.RTL)

    def _go(self, mode: Mode) -> None:
        """Change mode, or stop the motors where the vehicle stands on the ground."""
        v = self.vehicle
        if v.body.landed:
            v.arming.release()
        elif mode == Mode.LAND or not v.set_mode(mode):
            v.set_mode(Mode.LAND)
            v.land.wait()

    def _watch_battery(self) -> None:
        v = self.vehicle
        found = v.battery.worsened(v.time_s)
        if found is None:
            return
        word = "critical" if found is BatteryState.CRITICAL else "low"
        b = v.battery
        v.text(WARNING, f"Battery 1 is {word} {b.voltage_v:.2f}V used {b.consumed_mah:.0f} mAh")
        name = "BATT_FS_CRT_ACT" if found is BatteryState.CRITICAL else "BATT_FS_LOW_ACT"
        action = _BATTERY_ACTION.get(int(v.params[name]))
        v.text(WARNING, "Battery Failsafe")
        if action is not None and v.arming.armed:
            self._go(action)

    def _watch_ekf(self) -> None:
        v, e = self.vehicle, self.vehicle.estimator
        e.update(v.time_s)
        lost_s = e.lost_for_s(v.time_s)
        if v.arming.armed and lost_s >= VARIANCE_AFTER_S - 0.1 and not self._lane_switched:
            self._lane_switched = True
            v.text(CRITICAL, "EKF3 lane switch 1")
            v.text(WARNING, "EKF primary changed:1")
        if lost_s >= VARIANCE_AFTER_S and not e.variance_told and v.time_s > 10.0:
            e.variance_told = True
            v.text(CRITICAL, "EKF variance")
            self._ekf_lost()
        if lost_s >= STOPPED_AIDING_AFTER_S and e.aiding_told and not v.arming.armed:
            e.aiding_told = False
            v.text(WARNING, "EKF3 IMU0 stopped aiding")
            v.text(WARNING, "EKF3 IMU1 stopped aiding")
        if e.gps_present and e.variance_told and v.time_s - e.back_at_s >= RECOVERED_AFTER_S:
            e.variance_told, e.aiding_told = False, True
            self.ekf = False
            if self._ekf_acted:
                self._ekf_acted = False
                v.text(CRITICAL, "EKF Failsafe Cleared")

    def _ekf_lost(self) -> None:
        v = self.vehicle
        self.ekf = True
        if v.arming.armed and v.mode.number in NEEDS_POSITION and not v.body.landed:
            self._ekf_acted = True
            v.text(CRITICAL, "EKF Failsafe: changed to LAND Mode")
            self._go(Mode.LAND)

    def disarmed(self) -> None:
        """The primary EKF lane goes back to the first at disarming."""
        if self._lane_switched:
            self._lane_switched = False
            self.vehicle.text(WARNING, "EKF primary changed:0")

    def _watch_fence(self) -> None:
        v = self.vehicle
        if not v.params["FENCE_ENABLE"] or not v.arming.armed or v.body.landed:
            self.fence_breach = 0
            return
        before = self.fence_breach
        self.fence_breach = breach(v.params, v.store, v.position_from_home_m, v.origin)
        if not self.fence_breach or before:
            return
        self.fence_count += 1
        self.fence_time_s = v.time_s
        v.text(NOTICE, "Fence Breached")
        action = _FENCE_ACTION.get(int(v.params["FENCE_ACTION"]))
        if action is not None and not math.isnan(v.position_from_home_m[0]):
            self._go(action)

    def terrain_missing(self) -> None:
        """An item counts from the terrain, and terrain is switched off."""
        self.vehicle.text(CRITICAL, "Failsafe: Terrain data missing")
        self._go(Mode.RTL)

    def _watch_thrust(self) -> None:
        body = self.vehicle.body
        body.failed = self.vehicle.params["SIM_ENGINE_MUL"] < 0.5 and self.vehicle.arming.armed
        if (
            body.failed
            and not self._thrust_told
            and self.vehicle.motor_failed_for_s > _THRUST_LOSS_AFTER_S
        ):
            self._thrust_told = True
            self.vehicle.text(EMERGENCY, "Potential Thrust Loss (1)")
