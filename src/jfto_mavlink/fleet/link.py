"""The links to a fleet: one thread that drains them, and a way to hand it work from any other.

Nothing in the loop waits for a vehicle or a line: conversations are exchanges, links drop what they
cannot send. Callers wait in their own thread.
"""

from __future__ import annotations

import math
import os
import select
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from functools import partial
from types import TracebackType
from typing import TypeVar

from jfto_mavlink.dialect import Message
from jfto_mavlink.errors import LinkError, MavlinkError, RosterError, SigningError
from jfto_mavlink.files.tlog import TlogWriter
from jfto_mavlink.fleet.roster import Roster
from jfto_mavlink.fleet.station import GroundStation, StationSettings
from jfto_mavlink.flight.telemetry import LOST_AFTER_S
from jfto_mavlink.io.address import LinkAddress
from jfto_mavlink.io.framing import Frame
from jfto_mavlink.io.port import Port
from jfto_mavlink.io.transport import Peer
from jfto_mavlink.protocol.exchange import Activity, Context, Exchange, Report
from jfto_mavlink.protocol.timesync import Clock, PacedClock, ScaledClock
from jfto_mavlink.protocol.vehicle_state import VehicleState
from jfto_msgs_py.records.event import WARN, Event

# Longest sleep between two looks at clocks, in wall seconds.
LOOP_S = 0.05
# By then another vehicle under the same system id has sent two heartbeats and been asked.
ALONE_S = 2.5
# Whoever waits longer is told for whom.
TELL_AFTER_S = 2.0
T = TypeVar("T")


class FleetLink:
    """Vehicles of a roster over their links. Use as a context manager.

    `clock` is what their silences are counted on, the wall's where None, and `unix` UTC as they
    should have it. `on_event` is told, in the link's thread, what becomes of the link itself.
    """

    def __init__(
        self,
        roster: Roster,
        settings: StationSettings | None = None,
        *,
        clock: PacedClock | None = None,
        unix: Clock = time.time,
        on_event: Callable[[Event], None] | None = None,
    ) -> None:
        self.clock: PacedClock = clock or ScaledClock()
        self.roster = roster
        settings = settings or StationSettings()
        self._ports: dict[LinkAddress, Port] = {}
        self._logs: dict[str, TlogWriter] = {}
        self._unix = unix
        self._on_event = on_event
        self._wake_read, self._wake_write = os.pipe()
        os.set_blocking(self._wake_read, False)
        os.set_blocking(self._wake_write, False)
        self._calls: deque[Callable[[], None]] = deque()
        self._running: dict[Future[object], Activity[object]] = {}
        self._failure: Exception | None = None
        self._stopping = False
        try:
            for index, link in enumerate(roster.links):
                refused = partial(self._refused, link)
                self._ports[link] = Port(link, settings.id, index, settings.signer, refused=refused)
            if settings.log_directory is not None:
                for uav in roster.uavs:
                    self._logs[uav] = TlogWriter(settings.log_directory / f"{uav}.tlog")
        except Exception:
            self._release()
            raise
        self.station = GroundStation(
            roster,
            self._transmit,
            self.clock,
            unix,
            settings,
            self._write_log if self._logs else None,
        )
        self._thread = threading.Thread(target=self._loop, name="mavlink links", daemon=True)

    def __enter__(self) -> FleetLink:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Stop the loop and give all links back."""
        self._stopping = True
        self._wake()
        if self._thread.is_alive():
            self._thread.join()
        self._release()

    @property
    def ports(self) -> tuple[Port, ...]:
        """The open links."""
        return tuple(self._ports.values())

    @property
    def lost_after_s(self) -> float:
        """Silence after which a vehicle is lost, on `clock`.

        A busy computer stalls a sped-up simulation for seconds of its own time.
        """
        return LOST_AFTER_S * max(1.0, self.clock.speedup / 4)

    def vehicle(self, uav: str) -> VehicleState:
        """State of a vehicle, kept up to date by the loop."""
        return self.station.vehicle(uav)

    def start(
        self,
        uav: str,
        job: Callable[[Context], Exchange[T]],
        report: Callable[[str, Report], None] | None = None,
    ) -> Future[T]:
        """Begin a conversation; the future ends with its result or error."""
        future: Future[T] = Future()

        def begin() -> None:
            try:
                activity = self.station.submit(
                    uav, job, lambda r: report(uav, r) if report is not None else None
                )
            except MavlinkError as error:
                future.set_exception(error)
                return
            self._running[future] = activity  # type: ignore[index]

        self._call(begin)
        return future

    def run(
        self,
        jobs: Mapping[str, Callable[[Context], Exchange[T]]],
        report: Callable[[str, Report], None] | None = None,
    ) -> dict[str, T | Exception]:
        """Run conversations with several vehicles at once; each ends with a result or an error.

        Interrupting it (Ctrl-C) ends all of them where they stand.
        """
        futures = {uav: self.start(uav, job, report) for uav, job in jobs.items()}
        results: dict[str, T | Exception] = {}
        try:
            for uav, future in futures.items():
                error = future.exception()
                if error is not None and not isinstance(error, Exception):
                    raise error
                results[uav] = error if error is not None else future.result()
        except BaseException:
            self._call(lambda: self._cancel(futures.values()))
            raise
        return results

    def wait_heard(
        self, timeout_s: float, tell: Callable[[str], None] = lambda _text: None
    ) -> None:
        """Wait until each vehicle has told who it is, and a second one under its id would have.

        `timeout_s` is on `clock`. After 2 s of this computer `tell` is given who is waited for.
        Raises RosterError that names all missing vehicles, SigningError
        702 where their frames arrive.
        """
        until_s, told_s = self.clock() + timeout_s, time.monotonic() + TELL_AFTER_S
        done = threading.Event()
        while not done.wait(0.02):
            self._raise_failure()
            now_s, found = self.clock(), {u: t.identity for u, t in self.station.tracks.items()}
            missing = [uav for uav, identity in found.items() if not identity.known]
            fresh = [u for u, one in found.items() if now_s - (one.heard_s or now_s) < ALONE_S]
            if not missing and not fresh:
                break
            troubles = [found[uav].signing_trouble(now_s) for uav in missing]
            if missing and (all(troubles) or (any(troubles) and now_s >= until_s)):
                raise SigningError(702, " ".join(filter(None, troubles)))
            if missing and time.monotonic() >= told_s:
                told_s = math.inf
                tell(self._awaited(missing, timeout_s))
            if missing and now_s >= until_s:
                heard = sorted({system for _, system in self.station.foreign})
                others = f" Heard instead: system ids {heard}." if heard else ""
                raise RosterError(
                    205, f"{', '.join(missing)} not heard within {timeout_s:g} s.{others}"
                )
        for uav in self.roster.uavs:
            self.station.check_identity(uav)

    def _awaited(self, missing: list[str], timeout_s: float) -> str:
        """Who is waited for, and where."""
        entries = [entry for entry in self.roster.entries if entry.uav in missing]
        names = ", ".join(f"{each.uav} on {each.link}" for each in entries)
        return f"Waiting for {names}: not heard yet, for {timeout_s:g} s at most."

    def _refused(self, link: LinkAddress, frame: Frame, why: str) -> None:
        self.station.refused(link, frame, why)

    def _call(self, call: Callable[[], None]) -> None:
        self._raise_failure()
        self._calls.append(call)
        self._wake()

    def _raise_failure(self) -> None:
        if self._failure is not None:
            raise self._failure

    def _wake(self) -> None:
        try:
            os.write(self._wake_write, b"\0")
        except BlockingIOError:
            # The pipe is full of wake-ups already.
            return

    def _cancel(self, futures: object) -> None:
        for future in list(futures):  # type: ignore[call-overload]
            activity = self._running.pop(future, None)
            if activity is not None:
                activity.cancel()
                future.cancel()

    def _loop(self) -> None:
        try:
            while not self._stopping:
                self._once()
        except Exception as error:  # noqa: BLE001  the caller's thread raises it
            self._failure = error
        self._failure = self._failure or LinkError(103, "the bridge was closed.")
        while self._calls:
            self._calls.popleft()()
        for future in list(self._running):
            future.set_exception(self._failure)
        self._running.clear()

    def _once(self) -> None:
        now_s = time.monotonic()
        poll = select.poll()
        poll.register(self._wake_read, select.POLLIN)
        for port in self._ports.values():
            port.transport.maintain(now_s)
            more = port.transport.flush()
            fd = port.transport.fileno()
            if fd is not None:
                poll.register(fd, select.POLLIN | (select.POLLOUT if more else 0))
        wait_s = (self.station.next_s() - self.clock()) / self.clock.speedup
        poll.poll(1000 * min(max(wait_s, 0.0), LOOP_S))
        self._drain_wake()
        while self._calls:
            self._calls.popleft()()
        for link, port in self._ports.items():
            for peer, frame in port.receive():
                self.station.handle(link, peer, frame)
        self.station.tick()
        self._finish()

    def _drain_wake(self) -> None:
        try:
            os.read(self._wake_read, 65_536)
        except BlockingIOError:
            return

    def _finish(self) -> None:
        for future, activity in list(self._running.items()):
            if not activity.done:
                continue
            del self._running[future]
            if activity.error is not None:
                future.set_exception(activity.error)
            else:
                future.set_result(activity.result)

    def _transmit(self, link: LinkAddress, peer: Peer, message: Message) -> bytes:
        return self._ports[link].send(message, peer)

    def _write_log(self, uav: str, raw: bytes) -> None:
        """Append to a vehicle's log; a full disk ends the log, not the flight."""
        log = self._logs.get(uav)
        if log is None:
            return
        try:
            log.write(int(self._unix() * 1e6), raw)
        except OSError as error:
            self._logs.pop(uav).close()
            if self._on_event is not None:
                text = f"log {log.path} ended: {error.strerror}"
                self._on_event(Event(WARN, "log", uav, text, round(self.clock() * 1e9)))

    def _release(self) -> None:
        for port in self._ports.values():
            port.transport.close()
        for log in self._logs.values():
            log.close()
        self._ports.clear()
        self._logs.clear()
        for fd in (self._wake_read, self._wake_write):
            if fd >= 0:
                os.close(fd)
        self._wake_read = self._wake_write = -1
