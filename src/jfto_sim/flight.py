"""What flies: the parts between a flight mode and the body."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from jfto_sim.clock import Clock
from jfto_sim.motion.body import Body
from jfto_sim.motion.heading import Heading
from jfto_sim.motion.limits import Limits
from jfto_sim.parameters import Parameters
from jfto_sim.ports import Ports
from jfto_sim.position import Position

_SPOOL_UP_S, _SPOOL_AFTER_ARM_S = 0.9, 3.15


@dataclass
class Motors:
    """Whether the motors run, and since when; `when_stopped` is called each time they stop.

    `failed_for_s` is how long one of them has been failing. After being told to take off they
    hesitate for `hesitation_s` longer than they need.
    """

    clock: Clock
    hesitation_s: float
    armed: bool = False
    armed_at_s: float = 0.0
    failed_for_s: float = 0.0
    when_stopped: list[Callable[[], None]] = field(default_factory=list)

    def start(self) -> None:
        """Let them turn."""
        self.armed, self.armed_at_s = True, self.clock.time_s

    def stop(self) -> None:
        """Stop them and tell whom it concerns."""
        self.armed = False
        for action in self.when_stopped:
            action()

    def lift_at_s(self) -> float:
        """When they have the speed to lift the vehicle, if told to now."""
        now = self.clock.time_s
        spool_s = max(_SPOOL_UP_S, _SPOOL_AFTER_ARM_S - (now - self.armed_at_s))
        return now + spool_s + self.hesitation_s


@dataclass
class LandDetector:
    """What the autopilot makes of the ground, in seconds of its clock; the body knows the truth."""

    complete: bool = True
    down_since_s: float | None = None
    airborne_s: float = 0.0


@dataclass(frozen=True)
class Flight:
    """What a flight mode sees and steers."""

    clock: Clock
    params: Parameters
    ports: Ports
    body: Body
    heading: Heading
    limits: Limits
    position: Position
    motors: Motors
    land: LandDetector

    @property
    def down_and_still(self) -> bool:
        """Whether a landing is over."""
        return self.body.landed and self.land.complete
