"""Whether the vehicle may arm, with the autopilot's own words where it may not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_sim.battery import BatteryState
from jfto_sim.dialect import ACCEPTED, CRITICAL, FAILED, INFO
from jfto_sim.mission import items as kinds
from jfto_sim.modes.numbers import ARMABLE, MODE_NAMES, NEEDS_POSITION, Mode

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

FORCE = 21196
_CHECK_PERIOD_S, _FIRST_CHECK_S = 1.0, 0.281
_SHOW_EVERY_S, _SHOW_AGAIN_S = 30.0, 4.0
_ARMS_FROM_S = 2.0


class Arming:
    """Pre-arm checks once a second, arming and disarming."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.armed = False
        self.armed_at_s = 0.0
        self.passing = False
        self._next_s = _FIRST_CHECK_S
        self._shown_s = 0.0
        self._report_at_once = False

    @property
    def next_s(self) -> float:
        """When the checks run next."""
        return self._next_s

    def tick(self) -> None:
        """Run the checks and say what fails, at once when it begins and every 30 s after."""
        now = self.vehicle.time_s
        if now + 1e-9 < self._next_s:
            return
        self._next_s += _CHECK_PERIOD_S
        if self.armed:
            self.passing = True
            return
        faults = self.faults()
        since = now - self._shown_s
        show = since > _SHOW_EVERY_S or (
            self._report_at_once and bool(faults) and since > _SHOW_AGAIN_S
        )
        if show:
            self._shown_s = now
            self._report_at_once = False
            self.show("PreArm", faults)
        if not faults:
            self._report_at_once = True
        self.passing = not faults

    def show(self, prefix: str, faults: list[str]) -> None:
        """One text per fault."""
        for fault in faults:
            self.vehicle.text(CRITICAL, f"{prefix}: {fault}")

    def faults(self) -> list[str]:
        """Why the vehicle should not be armed, in the autopilot's order and words."""
        v = self.vehicle
        now, found = v.time_s, []
        if not v.estimator.active(now):
            return [
                "Accels inconsistent",
                "EKF attitude is bad",
                "AHRS: not using configured AHRS type",
            ]
        if any(v.params[f"SIM_MAG{n}_FAIL"] for n in (1, 2, 3)):
            found.append("Compass not healthy")
        found += self._battery_faults()
        if v.mode.number in NEEDS_POSITION:
            if not v.estimator.gps_present:
                found.append("GPS 1: Bad fix")
            elif not v.estimator.position_ok(now):
                found.append("Need Position Estimate")
        found += self._mission_faults()
        return found

    def _battery_faults(self) -> list[str]:
        v = self.vehicle
        found = []
        if v.battery.voltage_v < v.params["BATT_ARM_VOLT"]:
            found.append("Battery 1 below minimum arming voltage")
        if v.battery.state is not BatteryState.HEALTHY:
            found += ["Battery 1 low voltage failsafe", "Battery failsafe"]
        return found

    def _mission_faults(self) -> list[str]:
        v = self.vehicle
        found = []
        mission = v.store.mission
        wanted = int(v.params["ARMING_MIS_ITEMS"])
        if wanted & 8 and not any(i.command == kinds.TAKEOFF for i in mission[1:]):
            found.append("Missing mission item: takeoff")
        if v.mode.number == Mode.AUTO and len(mission) <= 1:
            found.append("Mode requires mission")
        if any(i.frame == kinds.TERRAIN for i in mission):
            found.append("waiting for terrain data")
        return found

    def arm(self, *, force: bool) -> int:
        """MAV_CMD_COMPONENT_ARM_DISARM with param1 = 1."""
        v = self.vehicle
        if self.armed:
            return ACCEPTED
        faults = [] if force else self.faults()
        if not faults and v.mode.number not in ARMABLE:
            faults = [f"{MODE_NAMES[v.mode.number]} mode not armable"]
        if v.time_s < _ARMS_FROM_S and not faults:
            return FAILED
        if faults:
            self.show("Arm", faults)
            return FAILED
        self.armed = True
        self.armed_at_s = v.time_s
        if v.estimator.position_ok(v.time_s):
            v.move_home()
        v.text(INFO, "Arming motors")
        return ACCEPTED

    def disarm(self, *, force: bool) -> int:
        """MAV_CMD_COMPONENT_ARM_DISARM with param1 = 0."""
        v = self.vehicle
        if not self.armed:
            return ACCEPTED
        if not v.body.landed and not force:
            return FAILED
        self.release()
        return ACCEPTED

    def release(self) -> None:
        """Stop the motors."""
        self.armed = False
        self.vehicle.text(INFO, "Disarming motors")
        self.vehicle.tell_parameter("MOT_THST_HOVER")
        self.vehicle.disarmed()
