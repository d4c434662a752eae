"""Flight modes: their numbers, what each needs, what each offers, and which one is in force."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import InitVar, dataclass
from enum import IntEnum

from jfto_sim.dialect import WARNING
from jfto_sim.estimator import Estimator
from jfto_sim.flight import Flight


class Mode(IntEnum):
    """Numbers as in HEARTBEAT.custom_mode."""

    STABILIZE = 0
    ALT_HOLD = 2
    AUTO = 3
    GUIDED = 4
    LOITER = 5
    RTL = 6
    LAND = 9
    BRAKE = 17


ARMABLE = frozenset({Mode.STABILIZE, Mode.ALT_HOLD, Mode.GUIDED, Mode.LOITER})
NEEDS_POSITION = frozenset({Mode.AUTO, Mode.GUIDED, Mode.LOITER, Mode.RTL, Mode.BRAKE})


class FlightMode:
    """One mode; `enter` may refuse, `step` moves the body's target. `active` while in force."""

    number: Mode

    def __init__(self, flight: Flight) -> None:
        self.flight = flight
        self.active = False

    def enter(self) -> bool:
        """Begin; false refuses the change."""
        return True

    def leave(self) -> None:
        """End."""

    def step(self, dt_s: float) -> None:
        """Move the target by one step."""

    @property
    def landing(self) -> bool:
        """Whether the mode brings the vehicle down."""
        return False

    @property
    def taking_off(self) -> bool:
        """Whether the mode lifts the vehicle off the ground."""
        return False

    @property
    def goal(self) -> tuple[float, float]:
        """Distance in metres and bearing in degrees to what is being flown to."""
        return 0.0, 0.0


@dataclass
class Modes:
    """The flight mode in force; `announce` is called when it has changed."""

    modes: InitVar[Iterable[FlightMode]]
    flight: Flight
    estimator: Estimator
    announce: Callable[[], None]

    def __post_init__(self, modes: Iterable[FlightMode]) -> None:
        self._table = {int(mode.number): mode for mode in modes}
        self.current = self._table[Mode.STABILIZE]
        self.current.active = True

    def set(self, number: int) -> bool:
        """Change the flight mode; says why where it cannot."""
        if number == self.current.number:
            return True
        mode = self._table.get(number)
        if mode is None:
            self.flight.ports.text(WARNING, f"No such mode {number}")
            return False
        if not self._may_enter(mode.number) or not mode.enter():
            name = mode.number.name
            self.flight.ports.text(WARNING, f"Mode change to {name} failed: init failed")
            return False
        self.current.leave()
        self.current.active, mode.active = False, True
        self.current = mode
        self.announce()
        return True

    def _may_enter(self, mode: Mode) -> bool:
        """Once armed, some modes need a position."""
        armed = self.flight.motors.armed
        return not armed or mode not in NEEDS_POSITION or self.estimator.position_ok
