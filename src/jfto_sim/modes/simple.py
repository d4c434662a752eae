"""Modes without a plan of their own: manual ones with the sticks at rest, LOITER, BRAKE, LAND."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_sim.modes.base import Descent, FlightMode, Mover
from jfto_sim.modes.numbers import Mode

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

_BRAKE_MPS2, _BRAKE_JERK_MPS3 = 7.5, 40.0
_STICK_LOW_MPS = -2.5
_COAST_MPS2 = 0.7
_FAILSAFE_PAUSE_S = 4.0


class Brake(FlightMode):
    """BRAKE: come to rest as fast as possible and stay."""

    number = Mode.BRAKE

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.mover = Mover(vehicle)

    def enter(self) -> bool:
        """Needs a position once armed."""
        if self.vehicle.arming.armed and not self.vehicle.position_ok:
            return False
        self.mover.reset()
        self.vehicle.heading.hold(self.vehicle.heading.demand_deg)
        return True

    def step(self, dt_s: float) -> None:
        """Brake, hold the height."""
        self.mover.brake(_BRAKE_MPS2, _BRAKE_JERK_MPS3, dt_s)
        self.mover.climb(0.0, dt_s)
        self.mover.write()


class Loiter(FlightMode):
    """LOITER: coasts for LOIT_BRK_DELAY, brakes and stays over the place.

    The throttle stick is down, as in the recordings, and so the vehicle sinks.
    """

    number = Mode.LOITER

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.mover = Mover(vehicle)
        self._brakes_at_s = 0.0

    def enter(self) -> bool:
        """Needs a position once armed."""
        v = self.vehicle
        if v.arming.armed and not v.position_ok:
            return False
        self.mover.reset()
        self._brakes_at_s = v.time_s + v.params["LOIT_BRK_DELAY"]
        v.heading.hold(v.heading.demand_deg)
        return True

    def step(self, dt_s: float) -> None:
        """Coast or brake, sink."""
        v = self.vehicle
        braking = v.time_s >= self._brakes_at_s
        accel = v.params["LOIT_BRK_ACCEL"] / 100.0 if braking else _COAST_MPS2
        self.mover.brake(max(accel, 0.1), v.jerk_xy_mps3, dt_s)
        self.mover.climb(_STICK_LOW_MPS, dt_s)
        self.mover.write()


class Manual(FlightMode):
    """STABILIZE and ALT_HOLD with the throttle stick down, as the recordings have it: it sinks."""

    def __init__(self, vehicle: Vehicle, number: Mode) -> None:
        super().__init__(vehicle)
        self.number = number
        self.mover = Mover(vehicle)

    def enter(self) -> bool:
        """Always possible."""
        self.mover.reset()
        return True

    def step(self, dt_s: float) -> None:
        """Level, sinking."""
        p = self.vehicle.wpnav
        self.mover.brake(p.accel_mps2, self.vehicle.jerk_xy_mps3, dt_s)
        self.mover.climb(_STICK_LOW_MPS, dt_s)
        self.mover.write()


class Land(FlightMode):
    """LAND: straight down from where the vehicle can stop."""

    number = Mode.LAND

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.descent = Descent(vehicle)
        self._sinks_from_s = 0.0

    def enter(self) -> bool:
        """Always possible."""
        self.descent.start()
        self._sinks_from_s = 0.0
        return True

    def wait(self) -> None:
        """A failsafe waits a few seconds before it comes down."""
        self._sinks_from_s = self.vehicle.time_s + _FAILSAFE_PAUSE_S

    def step(self, dt_s: float) -> None:
        """Sink."""
        self.descent.step(dt_s, hold=self.vehicle.time_s < self._sinks_from_s)

    @property
    def landing(self) -> bool:
        """Always."""
        return True
