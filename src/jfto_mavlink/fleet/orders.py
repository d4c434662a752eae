"""Orders to a whole fleet, one at a time, answered in words: upload, check, start, …, abort.

Each method waits for the vehicles, so it is called in a thread of its own.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

from jfto_mavlink.dialect import MODES
from jfto_mavlink.errors import FlightError
from jfto_mavlink.fleet.fly import (
    Fleet,
    FlySettings,
    Release,
    check_fleet,
    check_upload,
    deliver_to_fleet,
    restore_fleet,
    start_fleet,
)
from jfto_mavlink.flight.control import StartLine, disarm, land, pause, resume, return_home
from jfto_mavlink.flight.follow import Progressed
from jfto_mavlink.mission.deliver import verify
from jfto_mavlink.preflight.settings import GateSettings
from jfto_mavlink.protocol.exchange import Context, Exchange, wait_until
from jfto_mavlink.protocol.vehicle_state import VehicleState
from jfto_msgs_py.records.vehicle import TimedTrajectory

# After this long the heartbeat shows whether a start under way has armed a vehicle.
SETTLE_S = 1.5
RESTORE_WAIT_S = 30.0
# Whoever is on the way home or down was sent there for a reason.
LEAVING = (MODES["RTL"], MODES["LAND"], MODES["SMART_RTL"])


@dataclass(frozen=True)
class OrderSettings:
    """Whether vehicles may be armed, what abort means, and the gate before a start.

    `start_away_s` says how far off the moment of the start is, s; None: as soon as all are ready.
    """

    may_arm: bool
    land_on_abort: bool = False
    gate: GateSettings = field(default_factory=GateSettings)
    start_away_s: Callable[[], float] | None = None


class FleetOrders:
    """Flies missions of a plan in AUTO; trajectories are offered to it and let be."""

    guided = False
    # Whether an operator holds the fleet.
    held = False

    def __init__(self, fleet: Fleet, settings: OrderSettings) -> None:
        self.fleet, self.settings = fleet, settings
        self.missions = dict(fleet.missions)
        self._release: Release | None = None
        self._line: StartLine | None = None
        self._starting = False
        self._aborted = False
        self._busy = threading.Lock()
        self._doing = ""

    def upload(self) -> str:
        """Hold the missions against the vehicles; upload, read back and compare all of them.

        All or none are released.
        """
        with self._order("upload"):
            self._release = None
            check_upload(self.fleet, self.settings.gate)
            sent = {uav: mission.mission for uav, mission in self.missions.items()}
            self._release = deliver_to_fleet(self.fleet.runner, sent, self.fleet.report).release()
            hashes = ", ".join(f"{u} {d[:12]}" for u, d in self._release.digests.items())
            return f"{len(sent)} missions on board and verified: {hashes}"

    def check(self) -> str:
        """Hold every vehicle at the gate before arming, and arm none."""
        with self._order("check"):
            release = self._release or self._read_back()
            check_fleet(self.fleet, release, self.settings.gate)
            return f"ready to arm: {', '.join(self.missions)}"

    def start(self) -> str:
        """Check, arm and start all vehicles; returns when all fly."""
        with self._start_order():
            release = self._release or self._read_back()
            away_s = self.settings.start_away_s
            at_s = None if away_s is None else self.fleet.runner.clock() + away_s()
            start_fleet(self.fleet, release, FlySettings(at_s, self.settings.gate), self._begun)
            return f"flying: {', '.join(self.missions)}"

    def pause(self) -> str:
        """Hold every vehicle that flies its mission."""
        with self._order("pause"):
            chosen = self._flying(lambda vehicle: vehicle.mode == MODES["AUTO"])
            self.held = True
            return self._all(chosen, pause, "paused")

    def resume(self) -> str:
        """Let all go on that are in the air and not on their way home or down."""
        with self._order("resume"):
            chosen = self._flying(lambda vehicle: vehicle.mode not in LEAVING)
            self.held = False
            return self._all(chosen, resume, "going on")

    def abort(self) -> str:
        """Bring all vehicles home, or down; whatever else is being done is called off."""
        if self.settings.land_on_abort:
            return self.land()
        return self._down(return_home, "returning")

    def land(self) -> str:
        """Let all vehicles land where they are; whatever else is being done is called off."""
        return self._down(land, "landing")

    def called_off(self) -> None:
        """Whatever else is being done ends."""
        self._aborted, self.held = True, False
        line = self._line
        if line is not None:
            line.failed = line.failed or "abort"
            line.reason = line.reason or "the operator aborted"

    def _down(self, how: Callable[[Context], Exchange[None]], doing: str) -> str:
        hurried = self._starting
        self.called_off()

        def job(context: Context) -> Exchange[str]:
            if hurried and not in_flight(context.vehicle):
                yield from wait_until(context, context.clock() + SETTLE_S)
            if in_flight(context.vehicle):
                yield from how(context)
                return doing
            yield from disarm(context)
            return "on the ground"

        return _told(self.fleet.run(job), str)

    def restore(self) -> str:
        """Put back the parameters that were set for a flight, on all vehicles that are down.

        What is left to put back stays on record. Raises FlightError 603 where one did not obey.
        """
        with self._order("restore"):
            had = tuple(self.fleet.changed.vehicles)
            failed = restore_fleet(self.fleet)
            if failed:
                raise FlightError(603, " ".join(["Parameters are not all put back:", *failed]))
            done = [uav for uav in had if uav not in self.fleet.changed.vehicles]
            return f"Parameters are as before the flight: {', '.join(done) or 'none were changed'}."

    @property
    def busy(self) -> bool:
        """Whether an order is being carried out."""
        return self._busy.locked()

    def close(self) -> None:
        """Nothing to end: missions are flown by the vehicles themselves."""

    def pick_up(self) -> None:
        """Nothing to go on with in mid-flight: missions are flown by the vehicles themselves."""

    def take(self, uav: str, trajectory: TimedTrajectory) -> None:
        """A vehicle's trajectory has come; may raise MissionError."""

    def progressed(self) -> Progressed | None:
        """Progress of what is streamed; None where nothing is."""
        return None

    def streaming(self, uav: str) -> str:  # noqa: ARG002
        """What the stream of a vehicle does, in words; "" where nothing is streamed."""
        return ""

    def begun_ns(self, flown_ns: Callable[[], int | None]) -> int | None:
        """Time zero of a flight, ns; `flown_ns` tells what the vehicles make of it."""
        return flown_ns()

    def _read_back(self) -> Release:
        """The release that an earlier run of this program gave, proven anew."""
        results = self.fleet.run(
            lambda context: verify(context, self.missions[context.uav].mission)
        )
        wrong = [uav for uav, result in results.items() if result]
        if wrong:
            raise FlightError(406, f"{', '.join(wrong)}: not the plan's mission on board. Upload.")
        return Release(
            {uav: mission.mission for uav, mission in self.missions.items()},
            {uav: mission.digest for uav, mission in self.missions.items()},
        )

    def _begun(self, line: StartLine) -> None:
        self._line = line
        if self._aborted:
            raise FlightError(601, "start called off, because the operator aborted.")

    def _flying(self, wanted: Callable[[VehicleState], bool]) -> list[str]:
        vehicles = {uav: self.fleet.runner.vehicle(uav) for uav in self.missions}
        chosen = [uav for uav, v in vehicles.items() if in_flight(v) and wanted(v)]
        if not chosen:
            modes = ", ".join(
                f"{uav} {v.mode_name if in_flight(v) else 'on the ground'}"
                for uav, v in vehicles.items()
            )
            raise FlightError(601, f"No vehicle that could: {modes}.")
        return chosen

    def _all(self, chosen: list[str], job: Callable[[Context], Exchange[None]], doing: str) -> str:
        results = self.fleet.runner.run(dict.fromkeys(chosen, job), self.fleet.report)
        others = [uav for uav in self.missions if uav not in chosen]
        rest = f"; left alone: {', '.join(others)}" if others else ""
        return _told(results, lambda _result: doing) + rest

    @contextmanager
    def _order(self, verb: str) -> Iterator[None]:
        # Parameters are put back by nobody's order: whoever gives one waits for that.
        if not self._busy.acquire(timeout=RESTORE_WAIT_S if self._doing == "restore" else 0.0):
            raise FlightError(605, f"{verb}: {self._doing} is under way; abort or wait.")
        self._doing = verb
        try:
            yield
        finally:
            self._busy.release()

    @contextmanager
    def _start_order(self) -> Iterator[None]:
        if not self.settings.may_arm:
            raise FlightError(
                606, "No vehicle is armed: set the parameter allow_arming to let start arm them."
            )
        with self._order("start"):
            self._aborted, self._starting, self._line = False, True, None
            try:
                yield
            except Exception:
                # Whoever is in the air has its parameters back once it is down.
                restore_fleet(self.fleet)
                raise
            finally:
                self._starting, self._line = False, None


def in_flight(vehicle: VehicleState) -> bool:
    """Whether a vehicle is armed and not known to stand on the ground."""
    return vehicle.in_flight


def _told(results: Mapping[str, object], doing: Callable[[object], str]) -> str:
    """What became of each vehicle; raises FlightError 603 where one did not obey."""
    failed = [str(result) for result in results.values() if isinstance(result, Exception)]
    done = [f"{u} {doing(r)}" for u, r in results.items() if not isinstance(r, Exception)]
    if failed:
        raise FlightError(603, " ".join([*failed, *(f"{text}." for text in done)]))
    return ", ".join(done)
