"""Station, battery, EKF, fence and motor failsafes."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_sim.battery import Battery, BatteryState
from jfto_sim.dialect import CRITICAL, EMERGENCY, NOTICE, WARNING, Message
from jfto_sim.estimator import (
    RECOVERED_AFTER_S,
    STOPPED_AIDING_AFTER_S,
    VARIANCE_AFTER_S,
    Estimator,
)
from jfto_sim.flight import Flight
from jfto_sim.mission.fence import Fence
from jfto_sim.modes.mode import NEEDS_POSITION, Mode, Modes
from jfto_sim.modes.simple import Land
from jfto_sim.ports import MessageHandler

CONTINUE_IN_AUTO = 2  # bit of FS_OPTIONS
# There is no SmartRTL here: who asks for it is brought home by RTL.
_BATTERY_ACTION = {
    1: Mode.LAND, 2: Mode.RTL, 3: Mode.RTL, 4: Mode.RTL, 6: Mode.RTL, 7: Mode.BRAKE
}  # fmt: skip
_TERMINATE = 5
_FENCE_ACTION = {2: Mode.LAND, 4: Mode.BRAKE}
_STATION_ACTION = {5: Mode.LAND, 7: Mode.BRAKE}
_GIVE_UP_M = 100.0
_THRUST_LOSS_AFTER_S = 3.9


@dataclass
class Failsafes:
    """Watches what can go wrong, and changes the mode of `modes`; `land` is its LAND mode."""

    flight: Flight
    battery: Battery
    estimator: Estimator
    fence: Fence
    modes: Modes
    land: Land
    fence_count: int = 0
    fence_time_s: float = 0.0
    _last_heartbeat_s: float | None = None
    _station: bool = False
    _ekf: bool = False
    _ekf_acted: bool = False
    _variance_reported: bool = False
    _aiding_reported: bool = True
    _lane_switched: bool = False
    _thrust_reported: bool = False

    def __post_init__(self) -> None:
        self.messages: dict[str, MessageHandler] = {"HEARTBEAT": self._heartbeat}
        self.flight.motors.when_stopped.append(self._motors_stopped)

    @property
    def station_lost(self) -> bool:
        """Whether the station's failsafe is in force."""
        return self._station

    @property
    def critical(self) -> bool:
        """Whether a failsafe is in force; HEARTBEAT shows it as system status 5."""
        return self._station or self._ekf or self.battery.state > BatteryState.HEALTHY

    def tick(self) -> None:
        """Look at everything once; called ten times a second."""
        self._watch_battery()
        self._watch_ekf()
        self._watch_station()
        self._watch_fence()
        self._watch_thrust()

    def _go(self, mode: Mode) -> None:
        """Change mode, or stop the motors where the vehicle stands on the ground."""
        if self.flight.body.landed:
            self.flight.motors.stop()
        elif mode == Mode.LAND or not self.modes.set(mode):
            self.modes.set(Mode.LAND)
            self.land.wait()

    def _heartbeat(self, m: Message, _port: int) -> None:
        """A heartbeat of SYSID_MYGCS arrived."""
        if m.get_srcSystem() != self.flight.params["SYSID_MYGCS"]:
            return
        self._last_heartbeat_s = self.flight.clock.time_s
        if self._station:
            self._station = False
            self.flight.ports.text(WARNING, "GCS Failsafe Cleared")

    def _watch_station(self) -> None:
        params = self.flight.params
        action = int(params["FS_GCS_ENABLE"])
        if action == 0 or self._last_heartbeat_s is None or self._station:
            return
        if self.flight.clock.time_s - self._last_heartbeat_s < params["FS_GCS_TIMEOUT"]:
            return
        self._station = True
        if not self.flight.motors.armed:
            self.flight.ports.text(WARNING, "GCS Failsafe")
            return
        if self._stopped_on_ground("GCS"):
            return
        on_mission = self.modes.current.number is Mode.AUTO
        if on_mission and int(params["FS_OPTIONS"]) & CONTINUE_IN_AUTO:
            self.flight.ports.text(WARNING, "GCS Failsafe - Continuing Auto Mode")
            return
        self.flight.ports.text(WARNING, "GCS Failsafe")
        self._go(_STATION_ACTION.get(action, Mode.RTL))

    def _stopped_on_ground(self, what: str) -> bool:
        """Stop the motors of a vehicle that is not in the air, and say so."""
        if not self.flight.body.landed or self.modes.current.taking_off:
            return False
        self.flight.motors.stop()
        self.flight.ports.text(WARNING, f"{what} Failsafe - Disarming")
        return True

    def _watch_battery(self) -> None:
        battery = self.battery
        if not self.flight.motors.armed:
            return
        found = battery.worsened(self.flight.clock.time_s)
        if found is None:
            return
        critical = found is BatteryState.CRITICAL
        self.flight.ports.text(
            WARNING,
            f"Battery 1 is {'critical' if critical else 'low'} {battery.voltage_v:.2f}V "
            f"used {battery.consumed_mah:.0f} mAh",
        )
        name = "BATT_FS_CRT_ACT" if critical else "BATT_FS_LOW_ACT"
        if self._stopped_on_ground("Battery"):
            return
        self.flight.ports.text(WARNING, "Battery Failsafe")
        action = int(self.flight.params[name])
        if action == _TERMINATE:
            self.flight.motors.stop()
        elif action in _BATTERY_ACTION:
            self._go(_BATTERY_ACTION[action])

    def _watch_ekf(self) -> None:
        estimator, now = self.estimator, self.flight.clock.time_s
        estimator.update()
        lost_s, armed = estimator.lost_for_s, self.flight.motors.armed
        if armed and lost_s >= VARIANCE_AFTER_S - 0.1 and not self._lane_switched:
            self._lane_switched = True
            self.flight.ports.text(CRITICAL, "EKF3 lane switch 1")
            self.flight.ports.text(WARNING, "EKF primary changed:1")
        if lost_s >= VARIANCE_AFTER_S and not self._variance_reported and now > 10.0:
            self._variance_reported = True
            self.flight.ports.text(CRITICAL, "EKF variance")
            self._ekf_lost()
        armed = self.flight.motors.armed
        if lost_s >= STOPPED_AIDING_AFTER_S and self._aiding_reported and not armed:
            self._aiding_reported = False
            self.flight.ports.text(WARNING, "EKF3 IMU0 stopped aiding")
            self.flight.ports.text(WARNING, "EKF3 IMU1 stopped aiding")
        back_s = now - estimator.back_at_s
        if estimator.gps_present and self._variance_reported and back_s >= RECOVERED_AFTER_S:
            self._variance_reported, self._aiding_reported = False, True
            self._ekf = False
            if self._ekf_acted:
                self._ekf_acted = False
                self.flight.ports.text(CRITICAL, "EKF Failsafe Cleared")

    def _ekf_lost(self) -> None:
        self._ekf = True
        flying = self.flight.motors.armed and not self.flight.body.landed
        if flying and self.modes.current.number in NEEDS_POSITION:
            self._ekf_acted = True
            self.flight.ports.text(CRITICAL, "EKF Failsafe: changed to LAND Mode")
            self._go(Mode.LAND)

    def _motors_stopped(self) -> None:
        """The primary EKF lane goes back to the first at disarming."""
        if self._lane_switched:
            self._lane_switched = False
            self.flight.ports.text(WARNING, "EKF primary changed:0")

    def _watch_fence(self) -> None:
        """A fence that is crossed is known on the ground too; only in flight it has a consequence.

        Each new crossing has it, so one who goes on outside is called back again.
        """
        fence, armed = self.fence, self.flight.motors.armed
        before, new = fence.breached, 0
        if self.flight.position.known:
            new = fence.check(self.flight.clock.time_s)
        if new and not before:
            self.fence_count += 1
            self.fence_time_s = self.flight.clock.time_s
        if not new or not armed:
            return
        action = int(self.flight.params["FENCE_ACTION"])
        if self.flight.land.complete:
            if action:
                self.flight.motors.stop()
            return
        self.flight.ports.text(NOTICE, "Fence Breached")
        if not action:
            return
        wanted = Mode.LAND if fence.beyond_m > _GIVE_UP_M else _FENCE_ACTION.get(action, Mode.RTL)
        if not self.modes.set(wanted):
            self.modes.set(Mode.LAND)

    def terrain_missing(self) -> None:
        """An item counts from the terrain, and terrain is switched off."""
        self.flight.ports.text(CRITICAL, "Failsafe: Terrain data missing")
        self._go(Mode.RTL)

    def _watch_thrust(self) -> None:
        body, motors = self.flight.body, self.flight.motors
        body.failed = self.flight.params["SIM_ENGINE_MUL"] < 0.5 and motors.armed
        if body.failed and not self._thrust_reported and motors.failed_for_s > _THRUST_LOSS_AFTER_S:
            self._thrust_reported = True
            self.flight.ports.text(EMERGENCY, "Potential Thrust Loss (1)")
