"""One step of the flight: mode, heading, body, ground."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_sim.battery import Battery
from jfto_sim.dialect import INFO
from jfto_sim.flight import Flight
from jfto_sim.modes.mode import Modes
from jfto_sim.wind import asked_wind_mps

_LAND_COMPLETE_AFTER_S, _DISARM_AFTER_S = 1.1, 2.1
_YAW_ALIGNED_ABOVE_M = 1.9


@dataclass
class FlightLoop:
    """Steps mode, heading, body and land detection; `flight_time_s` is the time in the air."""

    flight: Flight
    battery: Battery
    modes: Modes
    steady_wind_mps: tuple[float, float]
    flight_time_s: float = 0.0
    _yaw_aligned: bool = False

    def __post_init__(self) -> None:
        self.flight.motors.when_stopped.append(self._stopped)

    @property
    def wind_mps(self) -> tuple[float, float]:
        """Where the air moves to (east, north): the steady wind plus SIM_WIND_*."""
        east, north = asked_wind_mps(self.flight.params, self.flight.position.from_home_m[2])
        return self.steady_wind_mps[0] + east, self.steady_wind_mps[1] + north

    def step(self, dt_s: float) -> None:
        """Let the flight go on by `dt_s` seconds."""
        body, motors, land = self.flight.body, self.flight.motors, self.flight.land
        armed, was_down = motors.armed, body.landed
        thrust = body.thrust if armed and not was_down else 0.0
        self.battery.draw(armed=armed, thrust=thrust, dt_s=dt_s)
        self.flight.position.stir_noise(dt_s)
        if armed and not was_down:
            self._fly(0.5 * dt_s)
        self.modes.current.step(dt_s)
        if armed and motors.armed and not was_down and not body.landed:
            self._fly(0.5 * dt_s)
        if not motors.armed:
            return
        if body.failed:
            motors.failed_for_s += dt_s
        if body.landed:
            self._on_ground()
        elif was_down:
            land.complete, land.down_since_s = False, None
            self._yaw_aligned = False

    def _fly(self, dt_s: float) -> None:
        """Heading and body follow the target of the step before, as the autopilot's loops do."""
        body, target = self.flight.body, self.flight.body.target
        wanted, rate = self.flight.heading.step(
            (float(target[0, 0]), float(target[0, 1])),
            (float(target[1, 0]), float(target[1, 1])),
            dt_s,
        )
        body.turn(wanted, rate, dt_s)
        body.fly(self.wind_mps, dt_s)
        self.flight.land.airborne_s = self.flight.clock.time_s
        self.flight_time_s += dt_s
        if not self._yaw_aligned and body.position_m[2] > _YAW_ALIGNED_ABOVE_M:
            self._yaw_aligned = True
            for imu in (0, 1):
                self.flight.ports.text(INFO, f"EKF3 IMU{imu} MAG0 in-flight yaw alignment complete")
        if body.landed:
            self.flight.land.down_since_s = self.flight.clock.time_s
            self.flight.ports.text(INFO, f"SIM Hit ground at {body.hit_ground_mps:f} m/s")

    def _on_ground(self) -> None:
        land, motors, mode = self.flight.land, self.flight.motors, self.modes.current
        now = self.flight.clock.time_s
        if land.down_since_s is not None and not self.flight.body.failed:
            down_s = now - land.down_since_s
            if down_s >= _LAND_COMPLETE_AFTER_S:
                land.complete = True
            if down_s >= _DISARM_AFTER_S and mode.landing:
                motors.stop()
                return
        if not land.complete or mode.taking_off:
            return
        idle_since = max(motors.armed_at_s, land.airborne_s)
        delay_s = self.flight.params["DISARM_DELAY"]
        if delay_s > 0 and now - idle_since >= delay_s:
            motors.stop()

    def _stopped(self) -> None:
        self.flight.land.complete = self.flight.body.landed = True
