"""The graph, the conductor and the operator, brought together for one flight."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from jfto.flight.actions import ERROR, INFO, WARN, Ask, Order, Tell
from jfto.flight.conductor import Conductor, Stage
from jfto.flight.fleet_status import FleetStatus
from jfto.flight.interrupts import Interrupts
from jfto.flight.keys import ORDERS, Keys
from jfto.flight.outcome import Outcome
from jfto.flight.screen.state import FlightState
from jfto.flight.screen.tracker import FlightTracker
from jfto.flight.settings import LANDED, ConductSettings
from jfto.pipeline.directory import LOG_NAME
from jfto.supervision.graph_table import PARAMETERS_NAME, PREFLIGHT_NAME
from jfto.supervision.process import RESTARTS, NodeCommand
from jfto.supervision.supervisor import Death, Supervisor
from jfto_mavlink.preflight.page import Preflight, read_page
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.ros.installation import require_ros

if TYPE_CHECKING:
    from jfto.flight.client import Client

_LOOK_S = 0.2
_SHOW_EVERY_S = 0.5
_LAST_EVENTS_S = 3.0
# A dozen parameters per vehicle over a poor link.
_PARAMETERS_S = 30.0
_FORGOTTEN_S = 30.0
# Without one of these there is no flight; the rest is started again for as long as it lasts.
ESSENTIAL = ("mavlink_bridge", "simulated_fleet")
_RESTARTS = replace(RESTARTS, tries=1000)


class Operator(Protocol):
    """Who watches the flight and has the last word."""

    def tell(self, text: str, level: int) -> None:
        """A line, before anything flies."""

    def ask(self, idle: Callable[[], bool]) -> bool:
        """Whether the fleet may arm; waits for the operator for as long as `idle()` is true.

        `idle` takes a fraction of a second, in which the graph is listened to.
        """

    def page(self, page: Preflight) -> None:
        """What the checks before arming came to."""

    def show(self, state: FlightState) -> None:
        """How everything stands, twice a second from the start on."""


@dataclass(frozen=True)
class FlightJob:
    """What is flown: a plan, the processes of its graph, and how it is conducted."""

    title: str
    directory: Path
    plan: Plan
    nodes: tuple[NodeCommand, ...]
    settings: ConductSettings
    simulated: bool


@dataclass(frozen=True)
class FlightEnd:
    """How a flight ended, the fleet's last status, and how fast the vehicles' time passed."""

    outcome: Outcome
    fleet: FleetStatus
    speedup: float | None
    deaths: tuple[Death, ...] = ()


def fly(job: FlightJob, operator: Operator) -> FlightEnd:
    """Run the graph and conduct the flight; returns when it is over and all processes have ended.

    Raises InputError where another flight runs on this ROS domain.
    """
    require_ros()
    from jfto.flight.client import open_client

    conductor = Conductor(job.settings)
    tracker = FlightTracker(job.plan, job.title)

    def answered(verb: str, success: bool, text: str) -> None:
        if _tells_checks(job, verb, success=success):
            _show_page(job, operator)
        conductor.answered(verb, success=success, text=text)

    with (
        Interrupts() as interrupts,
        Keys() as keys,
        open_client(
            job.plan,
            tracker,
            answered,
            use_sim_time=job.simulated,
            # Nodes of a conductor that was killed take a while to end, and longer to be forgotten.
            patience_s=_FORGOTTEN_S if job.settings.resume else 0.0,
        ) as client,
        _supervised(job) as graph,
    ):
        return _Loop(job, operator, conductor, tracker, client, graph, (interrupts, keys)).run()


def _tells_checks(job: FlightJob, verb: str, *, success: bool) -> bool:
    """Whether an answer brings a page of checks that the operator has not seen."""
    if verb == "upload" and success:
        # No check follows where nobody is asked for the word.
        return not (job.simulated or job.settings.ask or job.settings.until != LANDED)
    return verb == "check" or (verb in {"upload", "start"} and not success)


def _show_page(job: FlightJob, operator: Operator) -> None:
    path = job.directory / PREFLIGHT_NAME
    if path.exists():
        operator.page(read_page(path))


class _Graph:
    """The supervised processes; deaths are kept for the loop."""

    def __init__(self, job: FlightJob) -> None:
        self.deaths: queue.SimpleQueue[Death] = queue.SimpleQueue()
        self._log = (job.directory / LOG_NAME).open("a", encoding="utf-8")
        essential = [node.name for node in job.nodes if node.name in ESSENTIAL]
        self._supervisor = Supervisor(
            job.nodes,
            job.directory,
            self._tell,
            _RESTARTS,
            essential,
            self.deaths.put,
        )
        self._thread = threading.Thread(target=self._supervisor.run, name="supervisor")

    def start(self) -> None:
        """Start all processes."""
        self._thread.start()

    @property
    def ended(self) -> bool:
        """Whether the supervisor has given up."""
        return not self._thread.is_alive()

    def close(self) -> None:
        """End all processes in the reverse order of their start."""
        self._supervisor.stop()
        self._thread.join()
        self._log.close()

    def _tell(self, name: str, text: str) -> None:
        print(f"{time.strftime('%H:%M:%S')}  {name:<15} {text}", file=self._log, flush=True)


@contextmanager
def _supervised(job: FlightJob) -> Iterator[_Graph]:
    graph = _Graph(job)
    graph.start()
    try:
        yield graph
    finally:
        graph.close()


class _Loop:
    """Looks, lets the conductor decide, and does what it says."""

    def __init__(
        self,
        job: FlightJob,
        operator: Operator,
        conductor: Conductor,
        tracker: FlightTracker,
        client: Client,
        graph: _Graph,
        hands: tuple[Interrupts, Keys],
    ) -> None:
        self._job, self._operator, self._conductor = job, operator, conductor
        self._tracker, self._client, self._graph = tracker, client, graph
        self._interrupts, self._keys = hands
        self._deaths: list[Death] = []
        self._flight: list[FleetStatus] = []
        self._shown_s = 0.0

    def run(self) -> FlightEnd:
        """Until the conductor has an outcome."""
        conductor, fleet = self._conductor, self._client.fleet()
        while conductor.outcome is None:
            self._client.spin(_LOOK_S, self._is_urgent)
            self._take_deaths()
            self._obey_operator()
            fleet = self._client.fleet()
            conductor.step(fleet)
            self._act()
            self._look(fleet)
        if conductor.outcome.flown:
            self._await_last_events()
        self._await_parameters()
        level = INFO if conductor.outcome.good else WARN
        self._client.publish_event(level, "order", conductor.outcome.text)
        return FlightEnd(conductor.outcome, fleet, self._speedup(), tuple(self._deaths))

    def _is_urgent(self) -> bool:
        return self._interrupts.pending or self._keys.pending()

    def _obey_operator(self) -> None:
        """Act on Ctrl-C and on keys at once, before anything else is looked at."""
        if self._in_flight:
            self._keys.listen()
        if self._interrupts.take():
            self._conductor.interrupt()
        key = self._keys.take()
        if key:
            self._conductor.order(*ORDERS[key])
        self._act()

    def _await_last_events(self) -> None:
        """How each flight ended, which the bridge tells a moment after all were seen down."""
        end_s = time.monotonic() + _LAST_EVENTS_S
        while not self._client.fleet_ended and time.monotonic() < end_s:
            self._client.spin(_LOOK_S)
        self._operator.show(self._tracker.state(self._client.now_ns, self._conductor.stage.value))

    def _await_parameters(self) -> None:
        """What was set for the flight is put back by the bridge; what it cannot reach is told."""
        path = self._job.directory / PARAMETERS_NAME
        end_s = time.monotonic() + _PARAMETERS_S
        while path.exists() and time.monotonic() < end_s:
            self._client.spin(_LOOK_S)
        if path.exists():
            text = f"Not all parameters are as before: jfto mission restore {path} --vehicles …"
            self._client.publish_event(WARN, "parameters", text)
            self._operator.tell(text, WARN)

    def _take_deaths(self) -> None:
        """Take in which processes have died."""
        while not self._graph.deaths.empty():
            death = self._graph.deaths.get()
            self._deaths.append(death)
            self._client.graph.forget(death.name)
            if death.name == "mavlink_bridge":
                self._client.drop_orders()
                self._conductor.bridge_died()
            if death.again_s is not None:
                done = f"it is started again after {death.again_s:.1f} s."
            elif death.name in ESSENTIAL:
                done = "it was given up, and nothing flies without it."
            else:
                done = "it was given up, and the flight goes on without it."
            text = f"{death.name} {death.how}: {done}"
            self._publish(text, WARN if death.again_s is not None else ERROR, "restart")
            if death.again_s is None and death.name in ESSENTIAL:
                self._conductor.gave_up(text)

    def _act(self) -> None:
        conductor = self._conductor
        for action in conductor.actions():
            if isinstance(action, Order):
                self._client.order(action.verb)
            elif isinstance(action, Tell):
                if not action.known:
                    self._client.publish_event(action.level, "order", action.text)
                self._show_line(action.text, action.level)
            elif isinstance(action, Ask):
                yes = self._operator.ask(self._idle)
                if not self._interrupts.pending:
                    conductor.confirmed(yes=yes)
                    self._act()

    def _idle(self) -> bool:
        self._client.spin(_LOOK_S)
        self._take_deaths()
        return not self._interrupts.pending and self._conductor.outcome is None

    def _publish(self, text: str, level: int, kind: str) -> None:
        """Tell everybody."""
        self._client.publish_event(level, kind, text)
        self._show_line(text, level)

    def _show_line(self, text: str, level: int) -> None:
        """In flight the screen shows it as an event; before there is one it is a line."""
        if not self._in_flight:
            self._operator.tell(text, level)

    @property
    def _in_flight(self) -> bool:
        return self._conductor.stage in {Stage.START, Stage.FLY, Stage.HOME}

    def _look(self, fleet: FleetStatus) -> None:
        if not self._in_flight:
            return
        self._tracker.going_home = self._conductor.stage == Stage.HOME
        if self._conductor.stage in {Stage.FLY, Stage.HOME}:
            self._flight = [*self._flight[:1], fleet]
        if fleet.now_s - self._shown_s >= _SHOW_EVERY_S:
            self._shown_s = fleet.now_s
            self._client.take_progress()
            doing = "" if self._conductor.stage == Stage.FLY else self._conductor.stage.value
            self._operator.show(self._tracker.state(self._client.now_ns, doing))

    def _speedup(self) -> float | None:
        """How much faster than this computer's the vehicles' time passed in flight."""
        if len(self._flight) < 2:
            return None
        first, last = self._flight
        return (last.fleet_s - first.fleet_s) / max(last.now_s - first.now_s, 1e-3)
