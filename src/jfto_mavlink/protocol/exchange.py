"""Conversations with one vehicle, written as generators that know no socket and no clock.

An exchange yields what it wants done and gets back what happened:

    Send(message)   send it now; answered with None
    Wait(until_s)   resume with the next message from the vehicle, or with None at that time
    Report(...)     tell the operator; answered with None

Time comes from `Context.clock`. Exchanges call each other with `yield from`. `Activity` runs one.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from jfto_mavlink.dialect import Message
from jfto_mavlink.io.port import Station
from jfto_mavlink.protocol.timesync import Clock, RoundTrip
from jfto_mavlink.protocol.vehicle_state import VehicleState

T = TypeVar("T")


@dataclass(frozen=True)
class Send:
    """Send a message to the vehicle."""

    message: Message


@dataclass(frozen=True)
class Wait:
    """Wait for the vehicle's next message, at most until a time of the context's clock."""

    until_s: float


@dataclass(frozen=True)
class Report:
    """Progress in words, and in steps where they can be counted."""

    text: str
    done: int = 0
    total: int = 0


Step = Send | Wait | Report
Exchange = Generator[Step, Message | None, T]


@dataclass
class Context:
    """What an exchange may know: who talks to whom, the vehicle as last heard, and the time.

    `ordered_mode` is the mode that this station last ordered, None if it has ordered none.
    """

    uav: str
    sysid: int
    station: Station
    vehicle: VehicleState
    clock: Clock
    compid: int = 1
    round_trip: RoundTrip = field(default_factory=RoundTrip)
    ordered_mode: int | None = None

    @property
    def target(self) -> tuple[int, int]:
        """System and component id of the vehicle, as messages want them."""
        return self.sysid, self.compid

    def addressed(self, message: Message) -> bool:
        """Whether an answer is meant for this station (or, in MAVLink 1 form, for anyone)."""
        system = getattr(message, "target_system", 0)
        component = getattr(message, "target_component", 0)
        return system in (0, self.station.system) and component in (0, self.station.component)


def wait_until(context: Context, until_s: float) -> Exchange[None]:
    """Let time pass, ignoring messages."""
    while context.clock() < until_s:
        yield Wait(until_s)


def wait_for(context: Context, condition: Callable[[], bool], timeout_s: float) -> Exchange[bool]:
    """Wait until the vehicle's state meets a condition; False after the time-out."""
    until_s = context.clock() + timeout_s
    while not condition():
        if context.clock() >= until_s:
            return False
        yield Wait(until_s)
    return True


class Activity(Generic[T]):
    """A running exchange. `feed` and `tick` drive it; `done` once it has returned or raised."""

    def __init__(
        self,
        exchange: Exchange[T],
        send: Callable[[Message], None],
        report: Callable[[Report], None],
    ) -> None:
        self._exchange = exchange
        self._send = send
        self._report = report
        self.deadline_s = float("-inf")
        self.done = False
        self.result: T | None = None
        self.error: BaseException | None = None
        self._advance(None)

    def feed(self, message: Message) -> None:
        """Hand over a message from the vehicle."""
        if not self.done:
            self._advance(message)

    def tick(self, now_s: float) -> None:
        """Let the exchange know that its waiting time is over, if it is."""
        if not self.done and now_s >= self.deadline_s:
            self._advance(None)

    def cancel(self) -> None:
        """End the exchange where it stands."""
        self._exchange.close()
        self.done = True

    def _advance(self, value: Message | None) -> None:
        try:
            step = self._exchange.send(value)
            while not isinstance(step, Wait):
                if isinstance(step, Send):
                    self._send(step.message)
                else:
                    self._report(step)
                step = self._exchange.send(None)
            self.deadline_s = step.until_s
        except StopIteration as stop:
            self.done, self.result = True, stop.value
        except Exception as error:  # noqa: BLE001  handed to whoever waits
            self.done, self.error = True, error
