"""Modes without a plan of their own: manual ones with the sticks at rest, LOITER, BRAKE, LAND."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_sim.modes.base import Descent, FlightMode, Mover
from jfto_sim.modes.numbers import Mode

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

_BRAKE_MPS2, _BRAKE_JERK_MPS3 = 7.5, 40.0
_STICK_LOW_MPS = -2.5


class Holding(FlightMode):
    """LOITER and BRAKE: come to rest and stay, LOITER more gently."""

    def __init__(self, vehicle: Vehicle, number: Mode) -> None:
        super().__init__(vehicle)
        self.number = number
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
        p = self.vehicle.wpnav
        if self.number == Mode.BRAKE:
            self.mover.brake(_BRAKE_MPS2, _BRAKE_JERK_MPS3, dt_s)
        else:
            self.mover.brake(p.accel_mps2, self.vehicle.jerk_xy_mps3, dt_s)
        self.mover.climb(0.0, dt_s)
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

    def enter(self) -> bool:
        """Always possible."""
        self.descent.start()
        return True

    def step(self, dt_s: float) -> None:
        """Sink."""
        self.descent.step(dt_s)

    @property
    def landing(self) -> bool:
        """Always."""
        return True
