"""Modes without a plan of their own: manual ones with the sticks at rest, LOITER, BRAKE, LAND.

The throttle stick is down, as in the recordings, and so the modes that follow it sink.
"""

from __future__ import annotations

from jfto_sim.flight import Flight
from jfto_sim.modes.mode import FlightMode, Mode, Mover
from jfto_sim.motion.shaping import sqrt_controller
from jfto_world.motion.arducopter.wpnav import WpNav

_BRAKE_MPS2, _BRAKE_JERK_MPS3 = 7.5, 40.0
_STICK_LOW_MPS = -2.5
_COAST_MPS2 = 0.7
_FAILSAFE_PAUSE_S = 4.0
_LAND_GAIN = 1.0


class _Stopping(FlightMode):
    """Comes to rest horizontally."""

    def __init__(self, flight: Flight) -> None:
        super().__init__(flight)
        self._mover = Mover(flight)

    def enter(self) -> bool:
        """From the vehicle's own motion."""
        self._mover.reset()
        return True

    def _stop(self, accel_mps2: float, jerk_mps3: float, climb_mps: float, dt_s: float) -> None:
        self._mover.brake(accel_mps2, jerk_mps3, dt_s)
        self._mover.climb(climb_mps, dt_s)
        self._mover.write()


class Manual(_Stopping):
    """STABILIZE and ALT_HOLD: level, sinking."""

    def __init__(self, flight: Flight, number: Mode) -> None:
        super().__init__(flight)
        self.number = number

    def step(self, dt_s: float) -> None:
        """Level, sinking."""
        limits = self.flight.limits
        self._stop(limits.wpnav.accel_mps2, limits.jerk_xy_mps3, _STICK_LOW_MPS, dt_s)


class Brake(_Stopping):
    """BRAKE: come to rest as fast as possible and stay."""

    number = Mode.BRAKE

    def enter(self) -> bool:
        """Keep the heading too."""
        self.flight.heading.hold()
        return super().enter()

    def step(self, dt_s: float) -> None:
        """Brake, hold the height."""
        self._stop(_BRAKE_MPS2, _BRAKE_JERK_MPS3, 0.0, dt_s)


class Loiter(_Stopping):
    """LOITER: coasts for LOIT_BRK_DELAY, brakes and stays over the place, sinking."""

    number = Mode.LOITER

    def enter(self) -> bool:
        """Keep the heading too."""
        self._brakes_at_s = self.flight.clock.time_s + self.flight.params["LOIT_BRK_DELAY"]
        self.flight.heading.hold()
        return super().enter()

    def step(self, dt_s: float) -> None:
        """Coast or brake, sink."""
        braking = self.flight.clock.time_s >= self._brakes_at_s
        accel = self.flight.params["LOIT_BRK_ACCEL"] / 100.0 if braking else _COAST_MPS2
        self._stop(max(accel, 0.1), self.flight.limits.jerk_xy_mps3, _STICK_LOW_MPS, dt_s)


class Land(FlightMode):
    """LAND: vertical at the speeds of LAND_*; touchdown is the body's business."""

    number = Mode.LAND

    def __init__(self, flight: Flight) -> None:
        super().__init__(flight)
        self._mover = Mover(flight)
        self._place_m: tuple[float, float] | None = None
        self._sinks_from_s = 0.0

    def enter(self) -> bool:
        """Where the vehicle can stop."""
        self.start(None)
        return True

    def start(self, place_m: tuple[float, float] | None) -> None:
        """Land at a place, east and north of the power-up point, or where the vehicle can stop."""
        self._mover.reset()
        self._place_m = place_m
        self._sinks_from_s = 0.0
        self.flight.heading.hold()

    def wait(self) -> None:
        """A failsafe waits a few seconds before it comes down."""
        self._sinks_from_s = self.flight.clock.time_s + _FAILSAFE_PAUSE_S

    def step(self, dt_s: float) -> None:
        """Sink: fast above LAND_ALT_LOW, then at LAND_SPEED."""
        limits, mover = self.flight.limits, self._mover
        p, jerk = limits.wpnav, limits.jerk_xy_mps3
        waiting = self.flight.clock.time_s < self._sinks_from_s
        mover.climb(0.0 if waiting else self._rate_mps(p, dt_s), dt_s)
        if self._place_m is None:
            mover.brake(p.accel_mps2, jerk, dt_s)
        else:
            still = ((0.0, 0.0), (0.0, 0.0))
            speeds = (p.speed_mps, p.accel_mps2, jerk)
            mover.level.towards_position(self._place_m, still, speeds, dt_s)
        mover.write()

    def _rate_mps(self, p: WpNav, dt_s: float) -> float:
        params = self.flight.params
        fast = params["LAND_SPEED_HIGH"] / 100.0 or p.speed_dn_mps
        slow = params["LAND_SPEED"] / 100.0
        above = params["LAND_ALT_LOW"] / 100.0 - self.flight.position.from_home_m[2]
        rate = sqrt_controller(above, _LAND_GAIN, p.accel_z_mps2, dt_s)
        return max(-max(fast, slow), min(-slow, rate))

    @property
    def landing(self) -> bool:
        """Always."""
        return True
