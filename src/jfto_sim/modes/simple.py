"""Modes without a plan of their own: manual ones with the sticks at rest, LOITER, BRAKE, LAND, RTL.

The throttle stick is down, as in the recordings, and so the modes that follow it sink.
"""

from __future__ import annotations

from jfto_sim.flight import Flight
from jfto_sim.modes.manoeuvres import Descent, Mover, ReturnHome
from jfto_sim.modes.mode import FlightMode, Mode

_BRAKE_MPS2, _BRAKE_JERK_MPS3 = 7.5, 40.0
_STICK_LOW_MPS = -2.5
_COAST_MPS2 = 0.7
_FAILSAFE_PAUSE_S = 4.0


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
    """LAND: straight down from where the vehicle can stop."""

    number = Mode.LAND

    def __init__(self, flight: Flight) -> None:
        super().__init__(flight)
        self._descent = Descent(flight)
        self._sinks_from_s = 0.0

    def enter(self) -> bool:
        """Always possible."""
        self._descent.start()
        self._sinks_from_s = 0.0
        return True

    def wait(self) -> None:
        """A failsafe waits a few seconds before it comes down."""
        self._sinks_from_s = self.flight.clock.time_s + _FAILSAFE_PAUSE_S

    def step(self, dt_s: float) -> None:
        """Sink."""
        self._descent.step(dt_s, hold=self.flight.clock.time_s < self._sinks_from_s)

    @property
    def landing(self) -> bool:
        """Always."""
        return True


class Rtl(FlightMode):
    """RTL as a mode."""

    number = Mode.RTL

    def __init__(self, flight: Flight) -> None:
        super().__init__(flight)
        self._home = ReturnHome(flight)

    def enter(self) -> bool:
        """From where the vehicle can stop."""
        self._home.start()
        return True

    def step(self, dt_s: float) -> None:
        """Go home."""
        self._home.step(dt_s)

    @property
    def landing(self) -> bool:
        """Whether it is coming down."""
        return self._home.landing

    @property
    def goal(self) -> tuple[float, float]:
        """Distance in metres and bearing in degrees to the end of the leg."""
        return self._home.nav.distance_m, self._home.nav.bearing_deg
