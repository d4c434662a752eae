"""The ground station without sockets: vehicles, their conversations, heartbeats, clocks.

`handle` takes frames, `tick` lets time pass; what is to be sent goes out through `transmit`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.errors import RosterError, SigningError
from jfto_mavlink.fleet.roster import Identity, Roster, RosterEntry
from jfto_mavlink.io.address import LinkAddress
from jfto_mavlink.io.framing import Frame
from jfto_mavlink.io.port import Station
from jfto_mavlink.io.signing import NO_KEY, Signer
from jfto_mavlink.io.transport import Peer
from jfto_mavlink.protocol.exchange import Activity, Context, Exchange, Report
from jfto_mavlink.protocol.setup import DEFAULT_RATES, ask_version, greet, missing_streams
from jfto_mavlink.protocol.timesync import Clock
from jfto_mavlink.protocol.vehicle_state import VehicleState, uid_text

HEARTBEAT_EVERY_S = 1.0
TIMESYNC_EVERY_S = 1.0
# Without heartbeats for this long nothing is asked for.
SILENT_S = 3.0
ASK_AGAIN_S = 5.0
ASK_STRANGER_S = 1.0
# A look at the links is late after this long: a busy computer, or one that slept.
DEAF_AFTER_S = 1.0
FOREIGN_KEPT = 256
# Never written to a log: it holds the signing key.
SECRET = frozenset((mavlink.MAVLINK_MSG_ID_SETUP_SIGNING,))
NS = 1_000_000_000

Transmit = Callable[[LinkAddress, Peer, Message], bytes]
Job = Callable[[Context], Exchange[object]]


@dataclass
class Track:
    """One vehicle of the roster and what is going on with it."""

    entry: RosterEntry
    vehicle: VehicleState
    identity: Identity
    context: Context
    activities: list[Activity[object]] = field(default_factory=list)
    greeting: Activity[object] | None = None
    greeted_boot: int = -1
    greeted_s: float = float("-inf")
    stranger_s: float = float("-inf")


@dataclass(frozen=True)
class StationSettings:
    """How a station speaks: its name on the wire, its signatures, the message rates (id to Hz).

    A .tlog per vehicle is written to `log_directory`; None: nowhere.
    """

    id: Station = field(default_factory=Station)
    signer: Signer | None = None
    rates: Mapping[int, float] = field(default_factory=lambda: DEFAULT_RATES)
    log_directory: Path | None = None


class GroundStation:
    """All vehicles of a roster. Not thread-safe: one thread owns it."""

    def __init__(
        self,
        roster: Roster,
        transmit: Transmit,
        clock: Clock,
        unix: Clock,
        settings: StationSettings,
        log: Callable[[str, bytes], None] | None = None,
    ) -> None:
        self.roster = roster
        self.id = settings.id
        self.foreign: Counter[tuple[str, int]] = Counter()
        self._transmit = transmit
        self._clock = clock
        self._unix = unix
        self._rates = settings.rates
        self._signs = settings.signer is not None
        self._log = log or (lambda _uav, _raw: None)
        self._heartbeat_s = self._timesync_s = self._looked_s = float("-inf")
        self.tracks = {entry.uav: self._track(entry) for entry in roster.entries}

    def _track(self, entry: RosterEntry) -> Track:
        vehicle = VehicleState(entry.uav)
        context = Context(
            entry.uav,
            entry.sysid,
            self.id,
            vehicle,
            self._clock,
            round_trip=vehicle.time_sync.round_trip,
        )
        identity = Identity(entry.uav, entry.sysid, entry.uid)
        return Track(entry, vehicle, identity, context)

    def vehicle(self, uav: str) -> VehicleState:
        """State of a vehicle; raises RosterError for a name that is not in the roster."""
        return self._named(uav).vehicle

    def submit(self, uav: str, job: Job, report: Callable[[Report], None]) -> Activity[object]:
        """Begin a conversation; raises RosterError if it is unclear who would answer."""
        track = self._named(uav)
        self.check_identity(uav)
        activity: Activity[object] = Activity(
            job(track.context), lambda message: self._send(track, message), report
        )
        track.activities.append(activity)
        return activity

    def check_identity(self, uav: str) -> None:
        """Raise RosterError if a vehicle is not, or not alone, who the roster says.

        SigningError 702 if its frames arrive, and their signatures keep us from speaking with it.
        """
        identity = self._named(uav).identity
        if identity.conflict:
            raise RosterError(204, identity.conflict)
        if identity.wrong_vehicle:
            raise RosterError(203, identity.wrong_vehicle)
        trouble = identity.signing_trouble(self._clock())
        if trouble:
            raise SigningError(702, trouble)

    def refused(self, link: LinkAddress, frame: Frame, why: str) -> None:
        """Take note of a frame that is not believed for its signature."""
        entry = self.roster.find(link, frame.system)
        if entry is not None:
            self.tracks[entry.uav].identity.note_signing(why, self._clock())

    def handle(self, link: LinkAddress, peer: Peer, frame: Frame) -> None:
        """Take in one frame."""
        entry = self.roster.find(link, frame.system)
        if entry is None:
            self._count_foreign(link, frame.system)
            return
        track, now_s, message = self.tracks[entry.uav], self._clock(), frame.message
        self._forgive(now_s)
        if frame.component != track.context.compid:
            return
        if frame.signed and not self._signs:
            track.identity.note_signing(NO_KEY, now_s)
        believed = track.identity.heard(peer, now_s)
        if message.get_type() == "AUTOPILOT_VERSION":
            track.identity.version(peer, uid_text(message))
        if not believed:
            return
        self._log(entry.uav, frame.raw)
        track.vehicle.update(message, now_s)
        if message.get_type() == "TIMESYNC":
            self._timesync(track, message)
        elif message.get_type() == "SYSTEM_TIME":
            track.vehicle.time_sync.system_time(message.time_unix_usec, self._unix())
        for activity in track.activities:
            activity.feed(message)

    def tick(self) -> None:
        """Do what is due now."""
        now_s = self._clock()
        self._forgive(now_s)
        if now_s >= self._heartbeat_s + HEARTBEAT_EVERY_S:
            self._heartbeat_s = now_s
            self._heartbeat()
        sync = now_s >= self._timesync_s + TIMESYNC_EVERY_S
        for track in self.tracks.values():
            for activity in track.activities:
                activity.tick(now_s)
            track.activities = [a for a in track.activities if not a.done]
            if track.vehicle.heartbeat_s is None:
                continue
            if sync:
                self._send(track, mavlink.MAVLink_timesync_message(0, int(now_s * NS)))
            self._keep_greeted(track, now_s)
        if sync:
            self._timesync_s = now_s

    def _forgive(self, now_s: float) -> None:
        """Count no silence while this program did not listen: frames were waiting or dropped."""
        deaf_s, self._looked_s = now_s - self._looked_s - DEAF_AFTER_S, now_s
        if deaf_s <= 0 or deaf_s == float("inf"):
            return
        for track in self.tracks.values():
            if track.vehicle.heartbeat_s is not None:
                track.vehicle.heartbeat_s = min(track.vehicle.heartbeat_s + deaf_s, now_s)

    def next_s(self) -> float:
        """When `tick` is due next, on the clock."""
        deadlines = [a.deadline_s for t in self.tracks.values() for a in t.activities]
        return min([self._heartbeat_s + HEARTBEAT_EVERY_S, *deadlines])

    def _named(self, uav: str) -> Track:
        track = self.tracks.get(uav)
        if track is None:
            names = ", ".join(self.tracks)
            raise RosterError(205, f"{uav} is not in the roster ({names}).")
        return track

    def _count_foreign(self, link: LinkAddress, system: int) -> None:
        key = (str(link), system)
        if key in self.foreign or len(self.foreign) < FOREIGN_KEPT:
            self.foreign[key] += 1

    def _send(self, track: Track, message: Message) -> None:
        raw = self._transmit(track.entry.link, track.identity.peer, message)
        if message.get_msgId() not in SECRET:
            self._log(track.entry.uav, raw)

    def _heartbeat(self) -> None:
        message = mavlink.MAVLink_heartbeat_message(
            mavlink.MAV_TYPE_GCS,
            mavlink.MAV_AUTOPILOT_INVALID,
            0,
            0,
            mavlink.MAV_STATE_ACTIVE,
            3,
        )
        sent = set()
        for track in self.tracks.values():
            target = (track.entry.link, track.identity.peer)
            if target not in sent:
                sent.add(target)
                self._transmit(*target, message)

    def _timesync(self, track: Track, message: Message) -> None:
        now_ns = int(self._clock() * NS)
        if message.tc1 == 0:
            self._send(track, mavlink.MAVLink_timesync_message(now_ns, message.ts1))
        elif track.vehicle.time_sync.answer(message.ts1, message.tc1, now_ns):
            track.vehicle.booted()

    def _ask_strangers(self, track: Track, now_s: float) -> None:
        """Ask who they are those that have not said so.

        A greeting that meets a deaf vehicle takes long to end, and a second vehicle under one
        system id must be found before anybody is written to.
        """
        unknown = track.identity.unknown_peers()
        if now_s - track.greeted_s <= ASK_AGAIN_S:
            unknown = tuple(peer for peer in unknown if peer != track.identity.peer)
        if not unknown or now_s - track.stranger_s <= ASK_STRANGER_S:
            return
        track.stranger_s = now_s
        if track.identity.peer in unknown:
            track.greeted_s = now_s
        for peer in unknown:
            self._transmit(track.entry.link, peer, ask_version(track.context))

    def _keep_greeted(self, track: Track, now_s: float) -> None:
        """Ask for identity and streams after contact, after a reboot, and when streams stop."""
        vehicle = track.vehicle
        if track.greeted_boot >= 0:
            self._ask_strangers(track, now_s)
        if track.greeting is not None and not track.greeting.done:
            if track.greeted_boot == vehicle.reboots:
                return
            track.greeting.cancel()
        fresh = track.greeted_boot != vehicle.reboots
        silent = vehicle.silent_s(now_s) > SILENT_S
        if silent or not (fresh or now_s - track.greeted_s > ASK_AGAIN_S):
            return
        wanted = self._rates
        if not fresh:
            wanted = missing_streams(vehicle, self._rates, track.greeted_s, now_s)
            if track.identity.known and not wanted:
                return
        track.greeted_boot, track.greeted_s = vehicle.reboots, now_s
        track.greeting = Activity(
            greet(track.context, wanted),
            lambda message: self._send(track, message),
            lambda _report: None,
        )
        track.activities.append(track.greeting)
