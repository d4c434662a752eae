"""The bridge and simulated vehicles in one process and in virtual time: no socket, no waiting.

Deterministic for a seed. What passes here runs the very code that talks to real vehicles, from the
bytes of the frames upward; only threads and sockets are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

from jfto_mavlink.dialect import Message
from jfto_mavlink.errors import MavlinkError
from jfto_mavlink.fleet.roster import Roster, RosterEntry
from jfto_mavlink.fleet.station import GroundStation, StationSettings
from jfto_mavlink.flight.telemetry import LOST_AFTER_S
from jfto_mavlink.io.address import LinkAddress
from jfto_mavlink.io.framing import Frame
from jfto_mavlink.io.port import Port, Station
from jfto_mavlink.io.signing import Signer
from jfto_mavlink.io.transport import Peer, Received
from jfto_mavlink.protocol.exchange import Activity, Context, Exchange, Report
from jfto_mavlink.protocol.setup import DEFAULT_RATES
from jfto_mavlink.protocol.vehicle_state import VehicleState
from jfto_sim import LinkFaults, Vehicle
from jfto_sim.faults import LossyPipe

T = TypeVar("T")
LINK = LinkAddress("udpin", "rehearsal", 1)
CLEAN = LinkFaults()


class AirLink:
    """Simulated vehicles as the other ends of one listening link, with faults each way.

    `port` is the vehicles' port that the station is on: the first accepts unsigned frames always.
    """

    def __init__(
        self,
        vehicles: Mapping[int, Vehicle],
        to_vehicle: LinkFaults = CLEAN,
        from_vehicle: LinkFaults = CLEAN,
        seed: int = 0,
        port: int = 0,
    ) -> None:
        self.dropped = 0
        self.now_s = 0.0
        self.port = port
        self.vehicles = dict(vehicles)
        self.up = {s: LossyPipe(to_vehicle, seed * 1000 + 2 * s) for s in vehicles}
        self.down = {s: LossyPipe(from_vehicle, seed * 1000 + 2 * s + 1) for s in vehicles}

    def advance(self, dt_s: float) -> None:
        """Let time pass for the vehicles and for the frames under way."""
        self.now_s += dt_s
        for key, vehicle in self.vehicles.items():
            for data in self.up[key].take(self.now_s):
                vehicle.handle(data, self.port)
            for port, frame in vehicle.advance(dt_s):
                if port == self.port:
                    self.down[key].put(frame, self.now_s)

    def set_faults(self, key: int, to_vehicle: LinkFaults, from_vehicle: LinkFaults) -> None:
        """Change what the link does to one vehicle's frames from now on."""
        self.up[key].faults, self.down[key].faults = to_vehicle, from_vehicle

    def fileno(self) -> int | None:
        """Nothing to wait on."""
        return None

    def receive(self) -> list[Received]:
        """Frames that have arrived."""
        return [
            (("vehicle", key), data)
            for key, pipe in self.down.items()
            for data in pipe.take(self.now_s)
        ]

    def send(self, data: bytes, peer: Peer) -> None:
        """Send to one vehicle."""
        if peer is None:
            self.dropped += 1
            return
        self.up[peer[1]].put(data, self.now_s)

    def flush(self) -> bool:
        """Nothing is queued."""
        return False

    def maintain(self, now_s: float) -> None:
        """Never down."""

    def close(self) -> None:
        """Nothing to give back."""


class Rehearsal:
    """A fleet of simulated vehicles behind the ground station. Its clock moves only in `advance`.

    `vehicles` are named as in the roster that is made of them; system ids come from their
    configurations. `step_s` is the time between two looks at the link.
    """

    def __init__(
        self,
        vehicles: Mapping[str, Vehicle],
        *,
        to_vehicle: LinkFaults = CLEAN,
        from_vehicle: LinkFaults = CLEAN,
        seed: int = 0,
        station: Station | None = None,
        signer: Signer | None = None,
        rates: Mapping[int, float] = DEFAULT_RATES,
        port: int = 0,
        step_s: float = 0.005,
        log: Callable[[str, bytes], None] | None = None,
    ) -> None:
        self.now_s = 0.0
        self.step_s = step_s
        self.lost_after_s = LOST_AFTER_S
        self.vehicles = dict(vehicles)
        station = station or Station()
        by_id = {vehicle.config.sysid: vehicle for vehicle in vehicles.values()}
        self.air = AirLink(by_id, to_vehicle, from_vehicle, seed, port)
        self.link = Port(LINK, station, 0, signer, self.air, self._refused)
        self.roster = Roster(
            tuple(RosterEntry(uav, v.config.sysid, LINK) for uav, v in vehicles.items())
        )
        first = next(iter(vehicles.values()))
        self.station = GroundStation(
            self.roster,
            self._transmit,
            self.clock,
            lambda: first.utc_us / 1e6,
            StationSettings(station, signer, rates),
            log,
        )

    def clock(self) -> float:
        """Seconds of virtual time."""
        return self.now_s

    def advance(self, duration_s: float) -> None:
        """Let time pass."""
        until_s = self.now_s + duration_s
        while self.now_s < until_s - 1e-9:
            self._step()

    def until(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Let time pass until a condition holds; False after the time-out."""
        until_s = self.now_s + timeout_s
        while not condition():
            if self.now_s >= until_s:
                return False
            self._step()
        return True

    def run(
        self,
        jobs: Mapping[str, Callable[[Context], Exchange[T]]],
        report: Callable[[str, Report], None] | None = None,
    ) -> dict[str, T | Exception]:
        """Run conversations with several vehicles at once; each ends with a result or an error."""
        running: dict[str, Activity[object]] = {}
        results: dict[str, T | Exception] = {}
        for uav, job in jobs.items():
            try:
                running[uav] = self.start(uav, job, report)
            except MavlinkError as error:
                results[uav] = error
        while not all(activity.done for activity in running.values()):
            self._step()
        for uav, activity in running.items():
            if activity.error is not None and not isinstance(activity.error, Exception):
                raise activity.error
            results[uav] = activity.error or activity.result  # type: ignore[assignment]
        return results

    def start(
        self,
        uav: str,
        job: Callable[[Context], Exchange[T]],
        report: Callable[[str, Report], None] | None = None,
    ) -> Activity[object]:
        """Begin a conversation that goes on while time passes."""
        tell = report or (lambda _uav, _report: None)
        return self.station.submit(uav, job, lambda step: tell(uav, step))

    def vehicle(self, uav: str) -> VehicleState:
        """State of a vehicle as last heard."""
        return self.station.vehicle(uav)

    def _step(self) -> None:
        self.now_s += self.step_s
        self.air.advance(self.step_s)
        for peer, frame in self.link.receive():
            self.station.handle(LINK, peer, frame)
        self.station.tick()

    def _refused(self, frame: Frame, why: str) -> None:
        self.station.refused(LINK, frame, why)

    def _transmit(self, _link: LinkAddress, peer: Peer, message: Message) -> bytes:
        return self.link.send(message, peer)
