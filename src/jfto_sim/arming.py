"""Whether the vehicle may arm, with the autopilot's own words where it may not."""

from __future__ import annotations

from collections.abc import Callable

from jfto_sim.battery import Battery, BatteryState
from jfto_sim.commands import Command, CommandHandler
from jfto_sim.dialect import ACCEPTED, CRITICAL, FAILED, INFO, UNSUPPORTED, mavlink
from jfto_sim.estimator import Estimator
from jfto_sim.flight import Flight
from jfto_sim.mission import items as kinds
from jfto_sim.mission.items import Store
from jfto_sim.modes.mode import ARMABLE, NEEDS_POSITION, Mode
from jfto_sim.ports import Ports

FORCE = 21196
_CHECK_PERIOD_S, _FIRST_CHECK_S = 1.0, 0.281
_SHOW_EVERY_S, _SHOW_AGAIN_S = 30.0, 4.0
_ARMS_FROM_S = 2.0


class Arming:
    """Pre-arm checks once a second, arming and disarming.

    `announce` tells the stations a parameter's value, `mode` is the flight mode in force.
    """

    def __init__(
        self,
        flight: Flight,
        battery: Battery,
        estimator: Estimator,
        store: Store,
        ports: Ports,
        announce: Callable[[str], None],
        mode: Callable[[], Mode],
    ) -> None:
        self.passing = False
        self.next_s = _FIRST_CHECK_S
        self._flight = flight
        self._battery = battery
        self._estimator = estimator
        self._store = store
        self._ports = ports
        self._announce = announce
        self._mode = mode
        self._shown_s = 0.0
        self._report_at_once = False
        self.commands: dict[int, CommandHandler] = {
            mavlink.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            mavlink.MAV_CMD_RUN_PREARM_CHECKS: self._run_checks,
        }
        flight.motors.when_stopped.append(self._disarmed)

    def tick(self) -> None:
        """Run the checks and say what fails, at once when it begins and every 30 s after."""
        now = self._flight.clock.time_s
        if now + 1e-9 < self.next_s:
            return
        self.next_s += _CHECK_PERIOD_S
        if self._flight.motors.armed:
            self.passing = True
            return
        faults = self.faults()
        since = now - self._shown_s
        if since > _SHOW_EVERY_S or (self._report_at_once and faults and since > _SHOW_AGAIN_S):
            self._shown_s = now
            self._report_at_once = False
            self._show("PreArm", faults)
        if not faults:
            self._report_at_once = True
        self.passing = not faults

    def _show(self, prefix: str, faults: list[str]) -> None:
        for fault in faults:
            self._ports.text(CRITICAL, f"{prefix}: {fault}")

    def faults(self) -> list[str]:
        """Why the vehicle should not be armed, in the autopilot's order and words."""
        if not self._estimator.active:
            return [
                "Accels inconsistent",
                "EKF attitude is bad",
                "AHRS: not using configured AHRS type",
            ]
        found = []
        if any(self._flight.params[f"SIM_MAG{n}_FAIL"] for n in (1, 2, 3)):
            found.append("Compass not healthy")
        found += self._battery_faults()
        if self._mode() in NEEDS_POSITION:
            if not self._estimator.gps_present:
                found.append("GPS 1: Bad fix")
            elif not self._estimator.position_ok:
                found.append("Need Position Estimate")
        return found + self._mission_faults()

    def _battery_faults(self) -> list[str]:
        found = []
        if self._battery.voltage_v < self._flight.params["BATT_ARM_VOLT"]:
            found.append("Battery 1 below minimum arming voltage")
        if self._battery.state is not BatteryState.HEALTHY:
            found += ["Battery 1 low voltage failsafe", "Battery failsafe"]
        return found

    def _mission_faults(self) -> list[str]:
        found = []
        mission = self._store.mission
        wanted = int(self._flight.params["ARMING_MIS_ITEMS"])
        if wanted & 8 and not any(i.command == kinds.TAKEOFF for i in mission[1:]):
            found.append("Missing mission item: takeoff")
        if self._mode() is Mode.AUTO and len(mission) <= 1:
            found.append("Mode requires mission")
        if any(i.frame == kinds.TERRAIN for i in mission):
            found.append("waiting for terrain data")
        return found

    def _arm_disarm(self, c: Command) -> int:
        force = c.p[1] == FORCE
        if c.p[0] == 1:
            return self.arm(force=force)
        return self.disarm(force=force) if c.p[0] == 0 else UNSUPPORTED

    def arm(self, *, force: bool) -> int:
        """Start the motors if nothing speaks against it, or by `force`; the MAV_RESULT."""
        motors = self._flight.motors
        if motors.armed:
            return ACCEPTED
        faults = [] if force else self.faults()
        if not faults and self._mode() not in ARMABLE:
            faults = [f"{self._mode().name} mode not armable"]
        if faults or self._flight.clock.time_s < _ARMS_FROM_S:
            self._show("Arm", faults)
            return FAILED
        motors.start()
        if self._estimator.position_ok:
            self._flight.position.move_home()
        self._ports.text(INFO, "Arming motors")
        return ACCEPTED

    def disarm(self, *, force: bool) -> int:
        """Stop the motors on the ground, or by `force` anywhere; the MAV_RESULT."""
        if self._flight.motors.armed:
            if not self._flight.body.landed and not force:
                return FAILED
            self._flight.motors.stop()
        return ACCEPTED

    def _run_checks(self, _c: Command) -> int:
        if self._flight.motors.armed:
            return FAILED
        self._show("PreArm", self.faults())
        return ACCEPTED

    def _disarmed(self) -> None:
        self._ports.text(INFO, "Disarming motors")
        self._announce("MOT_THST_HOVER")
