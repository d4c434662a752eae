"""The flight as the bridge keeps it: told to the operator, on disk, and found again after a death.

Its methods run in the node's executor, `under_way` in the link's thread.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import FlightError, MavlinkError
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.monitor import FlightMonitor, FlightState
from jfto_mavlink.flight.follow import Moment, UnderWay
from jfto_mavlink.flight.telemetry import LinkState
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.mission.changed import compare_parameters
from jfto_mavlink.mission.deliver import verify
from jfto_mavlink.protocol.exchange import Context, Exchange, wait_for
from jfto_mavlink.protocol.item import Mission
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import FileKind, read_record, write_record
from jfto_msgs_py.records.event import ERROR, WARN, Event

# How long vehicles that are not heard are waited for, s; once one is found, so many times what
# makes a vehicle lost.
HEARD_WAIT_S = 120.0
OTHERS_WAIT_TIMES = 3.0
_STATE_FILE = FileKind(
    "flight state", "It is written anew.", format="jfto-flight-state", version=2, size_limit=100_000
)


@dataclass(frozen=True)
class Recognised:
    """What a vehicle was doing when this program began.

    `mode` is "" where it is not in flight; then its mission is not read. `differs` says how the
    mission on board is not the plan's, "" if it is.
    """

    uav: str
    heard: bool
    mode: str = ""
    differs: str = ""


class FlightTime(Protocol):
    """Between the vehicles' clocks and the graph's; both give None while nobody can tell."""

    def begun_ns(self, moment: Moment) -> int | None:
        """Time zero, ns since the epoch, of a flight that vehicles began at a moment."""

    def own_s(self, context: Context, at_ns: int) -> float | None:
        """A time of the graph's on a vehicle's own clock; called in the link's thread."""


def recognise(context: Context, mission: Mission, heard_wait_s: float) -> Exchange[Recognised]:
    """Find out whether a vehicle flies, and read its mission back if it does; changes nothing.

    One that is not heard within `heard_wait_s` is not waited for.
    """
    uav, vehicle = context.uav, context.vehicle

    def known() -> bool:
        return vehicle.heartbeat_s is not None and vehicle.landed_state is not None

    if not (yield from wait_for(context, known, heard_wait_s)):
        return Recognised(uav, heard=False)
    if not vehicle.armed or vehicle.landed_state == mavlink.MAV_LANDED_STATE_ON_GROUND:
        return Recognised(uav, heard=True)
    try:
        differing = yield from verify(context, mission)
        differing += yield from compare_parameters(context, mission.parameters)
    except MavlinkError as error:
        differing = (str(error),)
    return Recognised(uav, True, vehicle.mode_name, differing[0] if differing else "")


def recognise_all(
    link: FleetLink, missions: Mapping[str, VehicleMission], found: Callable[[Recognised], None]
) -> None:
    """Find out which vehicles fly and what; `found` is called in the link's thread for each."""

    def note(uav: str, future: Future[Recognised]) -> None:
        failed = future.exception() is not None
        found(Recognised(uav, heard=False) if failed else future.result())

    for uav, mission in missions.items():
        job = partial(recognise, mission=mission.mission, heard_wait_s=HEARD_WAIT_S)
        link.start(uav, job).add_done_callback(partial(note, uav))


class WatchedFlight:
    """Watches a fleet's flight and tells of it; `path` is where its state is kept, None: nowhere.

    `lift_off` is called with the fleet's time zero (ns) once it is known. `guided` says that the
    plan is streamed.
    """

    def __init__(
        self,
        missions: Mapping[str, VehicleMission],
        path: Path | None,
        lost_after_s: float,
        tell: Callable[[Event], None],
        lift_off: Callable[[int], None],
        time: FlightTime,
        *,
        guided: bool = False,
    ) -> None:
        self._path, self._tell, self._lift_off, self._time = path, tell, lift_off, time
        self._guided = guided
        self._trouble = ""
        # What was kept counts once somebody is found in the air.
        self._flies = self._told = False
        self._found: dict[str, Recognised] = {}
        self._found_s = math.inf
        self._others_wait_s = OTHERS_WAIT_TIMES * lost_after_s
        self._uavs = tuple(missions)
        self._stamped: Moment | None = None
        digests = {uav: mission.digest for uav, mission in missions.items()}
        past = self._last_state(digests)
        self._state = FlightState(digests) if past is None or past.over else past
        self.monitor = FlightMonitor(missions, self._state, lost_after_s)

    def begin(self) -> None:
        """Say what could not be said before there was an executor, and when the flight began."""
        if self._trouble:
            self._tell(Event(WARN, "restart", "", self._trouble))
            self._trouble = ""
        if self._flies and self._state.lift_off_ns is not None:
            self._lift_off(self._state.lift_off_ns)

    @property
    def under_way(self) -> UnderWay | None:
        """Time zero, on a vehicle's own clock, of the flight that an earlier run began."""
        begun_ns = self._state.lift_off_ns
        if begun_ns is None:
            return None
        return lambda context: self._time.own_s(context, begun_ns)

    @property
    def down(self) -> bool:
        """Whether the flight is over, or there was none when this program began."""
        return self.monitor.over or (
            self._told and not self._flies and not any(self.monitor.flying)
        )

    def take(self, state: LinkState) -> None:
        """Tell what a vehicle's state brings, and keep it."""
        self._tell_found(state.at_s)
        for event in self.monitor.take(state):
            self._tell(event)
        self._keep()

    def found(self, vehicle: Recognised) -> None:
        """Take note of what a vehicle was found doing at the beginning."""
        self._found[vehicle.uav] = vehicle

    def _tell_found(self, now_s: float) -> None:
        """Say once what was found in the air, if anything; some may not be heard any more."""
        if self._told or not self._found:
            return
        self._found_s = min(self._found_s, now_s)
        found = {uav: self._found.get(uav, Recognised(uav, heard=False)) for uav in self._uavs}
        flying = {uav: one for uav, one in found.items() if one.mode}
        waited = flying and now_s > self._found_s + self._others_wait_s
        if len(self._found) < len(self._uavs) and not waited:
            return
        self._told = True
        if not flying:
            return
        self._flies = True
        if self._state.lift_off_ns is not None:
            self._lift_off(self._state.lift_off_ns)
        as_planned = "GUIDED" if self._guided else "AUTO"
        same = [uav for uav, one in flying.items() if one.mode == as_planned and not one.differs]
        silent = [uav for uav, one in found.items() if not one.heard]
        flown = "in GUIDED, as planned, with" if self._guided else "on"
        words = [f"{', '.join(same)} {flown} the plan's mission, as read back"] if same else []
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
        level = WARN if same == list(flying) and not silent else ERROR
        self._tell(Event(level, "restart", "", text))

    def _last_state(self, digests: Mapping[str, str]) -> FlightState | None:
        if self._path is None:
            return None
        try:
            return read_flight_state(digests, self._path)
        except FlightError as error:
            self._trouble = str(error)
            return None

    def _keep(self) -> None:
        """Publish a new time zero and write what is new."""
        monitor, before = self.monitor, self._state
        begun_ns = before.lift_off_ns if monitor.lifted else None
        if monitor.begun is not None and monitor.begun is not self._stamped:
            begun_ns = self._time.begun_ns(monitor.begun)
            self._stamped = None if begun_ns is None else monitor.begun
        state = FlightState(before.missions, begun_ns, monitor.ended, monitor.over)
        if state == before:
            return
        self._state = state
        if self._path is not None:
            try:
                write_flight_state(state, self._path)
            except InputError as error:
                self._tell(Event(WARN, "restart", "", str(error)))
        if begun_ns is not None and begun_ns != before.lift_off_ns:
            self._flies = True
            self._lift_off(begun_ns)


def write_flight_state(state: FlightState, path: Path) -> None:
    """Write what must be known of a flight; raises InputError."""
    write_record(state, path, _STATE_FILE)


def is_over(path: Path) -> bool:
    """Whether the flight was said to be over whose state is in a file; raises InputError."""
    return path.exists() and read_record(path, FlightState, _STATE_FILE).over


def read_flight_state(digests: Mapping[str, str], path: Path) -> FlightState | None:
    """The state of a flight of these very missions; None where there is none or it is another's.

    Raises FlightError 607 where the file does not hold one.
    """
    if not path.exists():
        return None
    try:
        state = read_record(path, FlightState, _STATE_FILE)
    except InputError as error:
        raise FlightError(
            607, f"{error} It does not say what flight is under way, and is written anew."
        ) from None
    return state if state.missions == dict(digests) else None
