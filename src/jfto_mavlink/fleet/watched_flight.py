"""The flight as the bridge keeps it: told to the operator, on disk, and found again after a death.

Its methods run in the node's executor, `under_way` in the bridge's thread.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import FlightError, MavlinkError
from jfto_mavlink.fleet.flight_state import FlightState, read_flight_state, write_flight_state
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.monitor import FlightMonitor
from jfto_mavlink.flight.follow import Moment, UnderWay
from jfto_mavlink.flight.telemetry import LinkState
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.mission.deliver import verify
from jfto_mavlink.protocol.exchange import Context, Exchange, wait_for
from jfto_mavlink.protocol.item import Mission
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.ros.events import ERROR, WARN

# How long vehicles that are not heard are waited for, s; once one is found, so many times what
# makes a vehicle lost.
HEARD_WAIT_S = 120.0
OTHERS_WAIT_TIMES = 3.0
# Level, kind, UAV or "" and the line.
Announce = Callable[[int, str, str, str], None]


@dataclass(frozen=True)
class Found:
    """What a vehicle was found doing when the bridge began."""

    uav: str
    vehicle: Recognised


def recognise_all(
    bridge: FleetLink, missions: Mapping[str, VehicleMission], found: Callable[[Found], None]
) -> None:
    """Find out which vehicles fly and what; `found` is called in the bridge's thread for each."""

    def note(uav: str, future: Future[Recognised]) -> None:
        failed = future.exception() is not None
        found(Found(uav, Recognised(heard=False) if failed else future.result()))

    for uav, mission in missions.items():
        job = partial(recognise, mission=mission.mission, heard_wait_s=HEARD_WAIT_S)
        bridge.start(uav, job).add_done_callback(partial(note, uav))


class WatchedFlight:
    """Watches a fleet's flight.

    `path` is the flight's book on disk, None for none. `stamp_ns` puts a moment on the graph's
    clock, `own_s` that clock (ns) on a vehicle's own; both give None while they cannot. `lift_off`
    is called with the fleet's time zero once it is known.
    """

    def __init__(
        self,
        missions: Mapping[str, VehicleMission],
        path: Path | None,
        lost_after_s: float,
        announce: Announce,
        lift_off: Callable[[int], None],
        stamp_ns: Callable[[Moment], int | None],
        own_s: Callable[[Context, int], float | None],
    ) -> None:
        self._path, self._announce, self._lift_off = path, announce, lift_off
        self._stamp_ns, self._own_s = stamp_ns, own_s
        self._trouble = ""
        # What the book says counts once somebody is found in the air.
        self._flies = self._told = False
        self._found: dict[str, Recognised] = {}
        self._found_s = math.inf
        self._others_wait_s = OTHERS_WAIT_TIMES * lost_after_s
        self._uavs = tuple(missions)
        self._stamped: Moment | None = None
        digests = {uav: mission.digest for uav, mission in missions.items()}
        book = self._last_book(digests)
        self._book = FlightState(digests) if book is None or book.over else book
        self.monitor = FlightMonitor(
            missions,
            under_way=self._book.begun_ns is not None,
            ended=self._book.ended,
            lost_after_s=lost_after_s,
        )

    def begin(self) -> None:
        """Say what could not be said before there was an executor, and when the flight began."""
        if self._trouble:
            self._announce(WARN, "restart", "", self._trouble)
            self._trouble = ""
        if self._flies and self._book.begun_ns is not None:
            self._lift_off(self._book.begun_ns)

    @property
    def under_way(self) -> UnderWay | None:
        """Time zero, on a vehicle's own clock, of the flight that an earlier bridge began."""
        begun_ns = self._book.begun_ns
        if begun_ns is None:
            return None
        return lambda context: self._own_s(context, begun_ns)

    def take(self, state: LinkState) -> None:
        """Tell what a vehicle's state brings, and keep it."""
        self._tell_found(state.at_s)
        for notice in self.monitor.take(state):
            self._announce(notice.level, notice.kind, notice.uav, notice.text)
        self._keep()

    def found(self, news: Found) -> None:
        """Take note of what a vehicle was found doing at the beginning."""
        self._found[news.uav] = news.vehicle

    def _tell_found(self, now_s: float) -> None:
        """Say once what was found in the air, if anything; some may not be heard any more."""
        if self._told or not self._found:
            return
        self._found_s = min(self._found_s, now_s)
        found = {uav: self._found.get(uav, Recognised(heard=False)) for uav in self._uavs}
        flying = {uav: one for uav, one in found.items() if one.mode}
        waited = flying and now_s > self._found_s + self._others_wait_s
        if len(self._found) < len(self._uavs) and not waited:
            return
        self._told = True
        if not flying:
            return
        self._flies = True
        if self._book.begun_ns is not None:
            self._lift_off(self._book.begun_ns)
        same = [uav for uav, one in flying.items() if one.mode == "AUTO" and not one.differs]
        silent = [uav for uav, one in found.items() if not one.heard]
        words = [f"{', '.join(same)} on the plan's mission, as read back"] if same else []
        words += [
            f"{uav} in {one.mode}"
            if not one.differs
            else f"{uav} in {one.mode} with a mission that is not the plan's ({one.differs})"
            for uav, one in flying.items()
            if uav not in same
        ]
        words += [f"{', '.join(silent)} not heard"] if silent else []
        text = (
            f"The bridge was started in mid-flight: {'; '.join(words)}. Nothing was uploaded, "
            "changed or disarmed; poses and orders go on."
        )
        self._announce(WARN if same == list(flying) and not silent else ERROR, "restart", "", text)

    def _last_book(self, digests: Mapping[str, str]) -> FlightState | None:
        if self._path is None:
            return None
        try:
            return read_flight_state(digests, self._path)
        except FlightError as error:
            self._trouble = str(error)
            return None

    def _keep(self) -> None:
        """Publish a new time zero and write what is new."""
        monitor, before = self.monitor, self._book
        begun_ns = before.begun_ns if monitor.lifted else None
        if monitor.begun is not None and monitor.begun is not self._stamped:
            begun_ns = self._stamp_ns(monitor.begun)
            self._stamped = None if begun_ns is None else monitor.begun
        book = FlightState(before.digests, begun_ns, monitor.ended, monitor.over)
        if book == before:
            return
        self._book = book
        if self._path is not None:
            try:
                write_flight_state(book, self._path)
            except InputError as error:
                self._announce(WARN, "restart", "", str(error))
        if begun_ns is not None and begun_ns != before.begun_ns:
            self._flies = True
            self._lift_off(begun_ns)


@dataclass(frozen=True)
class Recognised:
    """A vehicle as found. `differs` says how its mission on board is not the plan's, "" if it is.

    `mode` is "" where it is not in flight; then the mission is not read either.
    """

    heard: bool
    mode: str = ""
    differs: str = ""


def recognise(context: Context, mission: Mission, heard_wait_s: float) -> Exchange[Recognised]:
    """Find out whether a vehicle flies, and read its mission back if it does; changes nothing.

    One that is not heard within `heard_wait_s` is not waited for.
    """
    vehicle = context.vehicle

    def known() -> bool:
        return vehicle.heartbeat_s is not None and vehicle.landed_state is not None

    if not (yield from wait_for(context, known, heard_wait_s)):
        return Recognised(heard=False)
    if not vehicle.armed or vehicle.landed_state == mavlink.MAV_LANDED_STATE_ON_GROUND:
        return Recognised(heard=True)
    try:
        differing = yield from verify(context, mission)
    except MavlinkError as error:
        differing = (str(error),)
    return Recognised(heard=True, mode=vehicle.mode_name, differs=differing[0] if differing else "")
