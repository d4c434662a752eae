"""Flight modes: their numbers, what each offers, which is in force, and pieces that they share."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import InitVar, dataclass
from enum import IntEnum

from jfto_sim.dialect import WARNING
from jfto_sim.estimator import Estimator
from jfto_sim.flight import Flight
from jfto_sim.motion.shaping import LevelTarget, VerticalTarget

_TAKEOFF_SHARE, _TAKEOFF_SLOW = 0.9, 0.1


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


class Mover:
    """Shared target: a horizontal part and a vertical part, written to the body."""

    def __init__(self, flight: Flight) -> None:
        self.level = LevelTarget()
        self.vertical = VerticalTarget()
        self._body = flight.body
        self._limits = flight.limits

    def reset(self) -> None:
        """Start from the body's own motion."""
        x, y, z = self._body.position_m
        vx, vy, vz = self._body.velocity_mps
        self.level.reset((x, y), (vx, vy))
        self.vertical.reset(z, vz)
        self.write()

    def write(self) -> None:
        """Hand the target to the body."""
        target = self._body.target
        for k in (0, 1):
            target[0, k] = self.level.position_m[k]
            target[1, k] = self.level.velocity_mps[k]
            target[2, k] = self.level.accel_mps2[k]
        target[0, 2] = self.vertical.height_m
        target[1, 2] = self.vertical.climb_mps
        target[2, 2] = self.vertical.accel_mps2

    def brake(self, accel_mps2: float, jerk_mps3: float, dt_s: float) -> None:
        """Come to rest horizontally."""
        self.level.towards_velocity((0.0, 0.0), (0.0, 0.0), accel_mps2, jerk_mps3, dt_s)

    def climb(self, rate_mps: float, dt_s: float) -> None:
        """Climb or sink at a rate."""
        accel_z = self._limits.wpnav.accel_z_mps2
        self.vertical.towards_climb(rate_mps, accel_z, self._limits.jerk_z_mps3, dt_s)

    def climb_to(self, height_m: float, dt_s: float, feed_mps: float = 0.0) -> None:
        """Climb or sink to a height above the power-up point that itself moves at `feed_mps`."""
        p = self._limits.wpnav
        speeds = (p.speed_up_mps, p.speed_dn_mps)
        jerk = self._limits.jerk_z_mps3
        self.vertical.towards_height(height_m, speeds, p.accel_z_mps2, jerk, dt_s, feed_mps)


class Takeoff:
    """Straight up from the ground, or from where the vehicle is, to `height_m`."""

    def __init__(self, flight: Flight) -> None:
        self.mover = Mover(flight)
        self.height_m = 0.0
        self.done = False
        self._flight = flight
        self._start_m = 0.0
        self._begins_s = 0.0

    def start(self, height_m: float) -> None:
        """`height_m` above the power-up point; never below the present height."""
        body, now = self._flight.body, self._flight.clock.time_s
        self.mover.reset()
        self._start_m = body.position_m[2]
        self.height_m = max(height_m, self._start_m)
        self._begins_s = self._flight.motors.lift_at_s() if body.landed else now
        self.done = False

    def step(self, dt_s: float) -> None:
        """Climb once the motors are up to speed."""
        if self._flight.clock.time_s < self._begins_s:
            return
        if self._flight.body.landed:
            self._flight.body.lift_off()
            self.mover.reset()
        limits, target = self._flight.limits, self.mover.vertical
        self.mover.climb_to(self.height_m, dt_s)
        self.mover.brake(limits.wpnav.accel_mps2, limits.jerk_xy_mps3, dt_s)
        self.mover.write()
        wanted = _TAKEOFF_SHARE * (self.height_m - self._start_m)
        slow = target.climb_mps < _TAKEOFF_SLOW * limits.wpnav.speed_up_mps
        if target.height_m - self._start_m >= wanted and slow:
            self.done = True
