"""Whether the vehicle may arm, with the autopilot's own words where it may not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from jfto_sim.battery import Battery, BatteryState
from jfto_sim.commands import Command, CommandHandler
from jfto_sim.dialect import ACCEPTED, CRITICAL, FAILED, INFO, UNSUPPORTED, mavlink
from jfto_sim.estimator import Estimator
from jfto_sim.flight import Flight
from jfto_sim.mission import items as kinds
from jfto_sim.mission.fence import Fence
from jfto_sim.mission.items import Store
from jfto_sim.modes.mode import ARMABLE, NEEDS_POSITION, Mode, Modes

FORCE = 21196
_CHECK_PERIOD_S, _FIRST_CHECK_S = 1.0, 0.281
_SHOW_EVERY_S, _SHOW_AGAIN_S = 30.0, 4.0
_ARMS_FROM_S = 2.0
_ANGLE_MAX = (1000.0, 8000.0)
_FENCE_NEEDS_POSITION = "Fence enabled, need position estimate"


@dataclass
class Arming:
    """Pre-arm checks once a second, arming and disarming.

    `station_lost` says whether the station's failsafe is in force, `announce` tells the stations a
    parameter's value.
    """

    flight: Flight
    battery: Battery
    estimator: Estimator
    store: Store
    fence: Fence
    modes: Modes
    station_lost: Callable[[], bool]
    announce: Callable[[str], None]
    passing: bool = False
    next_s: float = _FIRST_CHECK_S
    _shown_s: float = 0.0
    _report_at_once: bool = False

    def __post_init__(self) -> None:
        self.commands: dict[int, CommandHandler] = {
            mavlink.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            mavlink.MAV_CMD_RUN_PREARM_CHECKS: self._run_checks,
        }
        self.flight.motors.when_stopped.append(self._disarmed)

    def tick(self) -> None:
        """Run the checks and say what fails, at once when it begins and every 30 s after."""
        now = self.flight.clock.time_s
        if now + 1e-9 < self.next_s:
            return
        self.next_s += _CHECK_PERIOD_S
        if self.flight.motors.armed:
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
            self.flight.ports.text(CRITICAL, f"{prefix}: {fault}")

    def faults(self) -> list[str]:
        """Why the vehicle should not be armed, in the autopilot's order and words."""
        found = [] if not self.station_lost() else ["GCS failsafe on"]
        found += self._parameter_faults()
        if not self.estimator.active:
            found += ["Accels inconsistent", "EKF attitude is bad"]
            if not self.fence.level:
                return [*found, "AHRS: not using configured AHRS type"]
        if any(self.flight.params[f"SIM_MAG{n}_FAIL"] for n in (1, 2, 3)):
            found.append("Compass not healthy")
        found += self._position_faults()
        if self.battery.fault():
            found.append(f"Battery 1 {self.battery.fault()}")
        found += self._mission_faults()
        if self.battery.state is not BatteryState.HEALTHY:
            found.append("Battery failsafe")
        if any(i.frame == kinds.TERRAIN for i in self.store.mission):
            found.append("waiting for terrain data")
        return [*found, *filter(None, [self.fence.fault()])]

    def _parameter_faults(self) -> list[str]:
        params = self.flight.params
        angle = params["ANGLE_MAX"]
        if not _ANGLE_MAX[0] <= angle <= _ANGLE_MAX[1]:
            return ["Check ANGLE_MAX"]
        return ["Check PILOT_SPEED_UP"] if params["PILOT_SPEED_UP"] <= 0 else []

    def _position_faults(self) -> list[str]:
        """A mode or a fence may need to know where the vehicle is."""
        moded = self.modes.current.number in NEEDS_POSITION
        if not moded and not self.fence.level:
            return []
        if not self.estimator.gps_present:
            return ["GPS 1: Bad fix"]
        if not self.estimator.has_origin:
            return ["AHRS: waiting for home"]
        if not self.estimator.position_ok:
            return ["Need Position Estimate" if moded else _FENCE_NEEDS_POSITION]
        return []

    def _mission_faults(self) -> list[str]:
        found = []
        mission = self.store.mission
        wanted = int(self.flight.params["ARMING_MIS_ITEMS"])
        if wanted & 8 and not any(i.command == kinds.TAKEOFF for i in mission[1:]):
            found.append("Missing mission item: takeoff")
        if self.modes.current.number is Mode.AUTO and len(mission) <= 1:
            found.append("Mode requires mission")
        return found

    def _arm_disarm(self, c: Command) -> int:
        force = c.p[1] == FORCE
        if c.p[0] == 1:
            return self.arm(force=force)
        return self.disarm(force=force) if c.p[0] == 0 else UNSUPPORTED

    def arm(self, *, force: bool) -> int:
        """Start the motors if nothing speaks against it, or by `force`; the MAV_RESULT."""
        motors = self.flight.motors
        if motors.armed:
            return ACCEPTED
        faults = [] if force else self.faults()
        if not faults and self.modes.current.number not in ARMABLE:
            faults = [f"{self.modes.current.number.name} mode not armable"]
        if faults or self.flight.clock.time_s < _ARMS_FROM_S:
            self._show("Arm", faults)
            return FAILED
        motors.start()
        if self.estimator.position_ok:
            self.flight.position.move_home()
        self.flight.ports.text(INFO, "Arming motors")
        return ACCEPTED

    def disarm(self, *, force: bool) -> int:
        """Stop the motors on the ground, or by `force` anywhere; the MAV_RESULT."""
        if self.flight.motors.armed:
            if not self.flight.body.landed and not force:
                return FAILED
            self.flight.motors.stop()
        return ACCEPTED

    def _run_checks(self, _c: Command) -> int:
        if self.flight.motors.armed:
            return FAILED
        self._show("PreArm", self.faults())
        return ACCEPTED

    def _disarmed(self) -> None:
        self.flight.ports.text(INFO, "Disarming motors")
        self.announce("MOT_THST_HOVER")
