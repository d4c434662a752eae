"""The station's half of a recording played to simulated vehicles, in simulated time."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_sim.config import VehicleConfig
from jfto_sim.dialect import Message, mavlink
from jfto_sim.vehicle import Vehicle
from support.conformance.recording import Recording

_SLICE_S = 0.02
_SECOND_STATION = 254
# (target system, frame number) of the first frames that the notes to a recording call misdirected
_ASTRAY = {"08_three_vehicles": {(2, 36): 1, (2, 37): 1}}


@dataclass(frozen=True)
class Answer:
    """A frame of a vehicle, recorded or simulated, on the vehicle's own clock."""

    system: int
    port: int
    epoch: int
    time_s: float
    message: Message


class _Player:
    """One simulated vehicle under replay; collects what it says."""

    def __init__(self, recording: Recording, system: int, parameters: dict[str, float]) -> None:
        self.system = system
        self.clock = recording.clocks[system]
        zero_s = self.clock.starts[0]
        first = next(
            (
                entry.message
                for _, entry in recording.entries
                if entry.system == system and entry.message.get_type() == "GPS_GLOBAL_ORIGIN"
            ),
            None,
        )
        place = {} if first is None else {
            "home_lat_deg": first.latitude * 1e-7,
            "home_lon_deg": first.longitude * 1e-7,
            "home_alt_m": first.altitude * 1e-3,
        }  # fmt: skip
        config = VehicleConfig(
            sysid=system, utc_at_boot_us=round(zero_s * 1e6), parameters=parameters, **place
        )
        self.vehicle = Vehicle(config)
        self.epoch = 0
        self.answers: list[Answer] = []
        self._codec = mavlink.MAVLink(None)
        self._codec.robust_parsing = True

    def until(self, wall_s: float) -> None:
        """Let the vehicle run up to a wall time of the recording."""
        epoch, now = self.clock.at(wall_s)
        while self.epoch < epoch:
            before = self.vehicle.time_s
            self._collect(self.vehicle.advance(_SLICE_S), before)
            if self.vehicle.boots == self.epoch + 1:
                self.vehicle.reboot()
            self.epoch += 1
        if self.vehicle.boots > self.epoch + 1:
            return  # it has restarted, as the recording will in a moment
        while self.vehicle.time_s < now - 1e-6:
            before = self.vehicle.time_s
            self._collect(self.vehicle.advance(min(_SLICE_S, now - before)), before)
            if self.vehicle.boots > self.epoch + 1:
                return

    def _collect(self, frames: list[tuple[int, bytes]], before_s: float) -> None:
        now = max(self.vehicle.time_s, before_s)  # a restart sets the clock back
        epoch = self.epoch
        for port, frame in frames:
            message = self._codec.decode(bytearray(frame))
            self.answers.append(Answer(self.system, port, epoch, now, message))


def _astray(recording: Recording) -> dict[int, int]:
    """Frames (by `id`) that the station sent to one vehicle on another one's link: its vehicle."""
    wanted = dict(_ASTRAY.get(recording.name, {}))
    found = {}
    for _, entry in recording.entries:
        sent = (getattr(entry.message, "target_system", 0), entry.message.get_seq())
        if entry.from_station and sent in wanted:
            found[id(entry)] = wanted.pop(sent)
    return found


def replay(
    recording: Recording, parameters: dict[str, float] | None = None
) -> tuple[list[Answer], list[Answer]]:
    """Returns (recorded answers, simulated answers), each in order of time per vehicle.

    `parameters` are those that the vehicles had been given before the recording began.
    """
    given = parameters or {}
    players = {system: _Player(recording, system, given) for system in _homes(recording)}
    ports_by_file = len({port for port, _ in recording.entries}) > 1
    astray = _astray(recording)
    recorded: list[Answer] = []
    for file_port, entry in recording.entries:
        if not entry.from_station:
            home = _home_of(entry.system, players)
            epoch, now = players[home].clock.at(entry.wall_s)
            recorded.append(Answer(home, file_port, epoch, now, entry.message))
            continue
        port = file_port
        if not ports_by_file and entry.system == _SECOND_STATION:
            port = 1
        link = astray.get(id(entry))
        for system, player in players.items():
            player.until(entry.wall_s)
            if link in (None, system):
                player.vehicle.handle(entry.raw, port)
    end = recording.entries[-1][1].wall_s
    for player in players.values():
        player.until(end + 0.5)
    simulated = [answer for player in players.values() for answer in player.answers]
    files = {port for port, _ in recording.entries}
    two_stations = any(entry.system == _SECOND_STATION for _, entry in recording.entries)
    kept = files if ports_by_file or not two_stations else {0, 1}
    return recorded, [answer for answer in simulated if answer.port in kept]


def _homes(recording: Recording) -> list[int]:
    """Systems that are vehicles of their own (a changed SYSID_THISMAV is not)."""
    return sorted(system for system in recording.clocks if system <= 3)


def _home_of(system: int, players: dict[int, _Player]) -> int:
    return system if system in players else min(players)
