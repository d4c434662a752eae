"""Who is who: UAV names, system ids, links, and which of several senders is to be believed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from jfto_mavlink.errors import RosterError
from jfto_mavlink.io.address import LinkAddress, parse_address
from jfto_mavlink.io.transport import Peer

SIMULATED = "sim"


@dataclass(frozen=True)
class RosterEntry:
    """One vehicle. `uid` is what AUTOPILOT_VERSION must report, "" for any."""

    uav: str
    sysid: int
    link: LinkAddress
    uid: str = ""


@dataclass(frozen=True)
class Roster:
    """The fleet, in the order of the plan."""

    entries: tuple[RosterEntry, ...]

    def __post_init__(self) -> None:
        for entry in self.entries:
            if not 1 <= entry.sysid <= 250:
                raise RosterError(201, f"{entry.uav}: system id {entry.sysid} is outside 1…250.")
        for name, values in (
            ("UAV name", [entry.uav for entry in self.entries]),
            ("system id", [str(entry.sysid) for entry in self.entries]),
            ("uid", [entry.uid for entry in self.entries if entry.uid]),
        ):
            for value, count in Counter(values).items():
                if count > 1:
                    raise RosterError(
                        202,
                        f"{name} {value} stands {count} times in the roster; give each its own.",
                    )
        if not self.entries:
            raise RosterError(201, "the roster is empty; name at least one vehicle.")

    @property
    def uavs(self) -> tuple[str, ...]:
        """Names in order."""
        return tuple(entry.uav for entry in self.entries)

    @property
    def links(self) -> tuple[LinkAddress, ...]:
        """Each link once, in order of first use."""
        return tuple(dict.fromkeys(entry.link for entry in self.entries))

    def find(self, link: LinkAddress, sysid: int) -> RosterEntry | None:
        """The vehicle expected on a link under a system id."""
        for entry in self.entries:
            if entry.sysid == sysid and entry.link == link:
                return entry
        return None


def parse_roster(texts: Sequence[str]) -> Roster:
    """Read entries of the form UAV=SYSID@LINK or UAV=SYSID@LINK#UID; raises RosterError."""
    return Roster(tuple(_parse_entry(text) for text in texts))


def are_simulated(texts: Sequence[str]) -> bool:
    """Whether texts name simulated vehicles: sim, or sim:N."""
    return any(text.partition(":")[0] == SIMULATED for text in texts)


def parse_vehicles(
    texts: Sequence[str], uavs: Sequence[str], endpoints: Sequence[str] = ()
) -> Roster | None:
    """The roster that texts name of the UAVs of a plan, None for simulated vehicles.

    `texts` is one of: sim or sim:N; links, one for all UAVs or one each, which then have the system
    ids 1, 2 …; entries UAV=SYSID[@LINK][#UID], of which those without a link take the `endpoints`,
    one for all or one each; nothing, where the endpoints are the links. Without a plan (no `uavs`)
    entries name whom they like, and links are those of uav1, uav2 … Raises RosterError and
    LinkAddressError.
    """
    if are_simulated(texts):
        _check_simulated(texts, uavs)
        return None
    if not any("=" in text for text in texts):
        endpoints = [*map(_link, texts)] or endpoints
        names = uavs or [f"uav{n}" for n in range(1, len(endpoints) + 1)]
        texts = [f"{uav}={n}" for n, uav in enumerate(names, 1)]
    roster = parse_roster(_with_links(texts, endpoints))
    odd = set(roster.uavs) ^ set(uavs)
    if uavs and odd:
        raise RosterError(
            205, f"{', '.join(sorted(odd))}: in the fleet or in the roster, not in both."
        )
    return roster


def _link(text: str) -> str:
    if ":" not in text:
        raise RosterError(
            201, f'"{text}" is neither a link, such as udpin:0.0.0.0:14550, nor UAV=SYSID@LINK.'
        )
    return str(parse_address(text))


def _with_links(texts: Sequence[str], endpoints: Sequence[str]) -> list[str]:
    bare = [text for text in texts if "@" not in text]
    links = [*endpoints] * len(bare) if len(endpoints) == 1 else [*endpoints]
    if len(links) != len(bare):
        raise RosterError(
            201,
            f"{len(bare)} roster entries have no @LINK and endpoints has {len(endpoints)}; "
            "give one for all, or one each.",
        )
    taken = iter(links)
    return [text if "@" in text else f"{text}@{next(taken)}" for text in texts]


def _check_simulated(texts: Sequence[str], uavs: Sequence[str]) -> None:
    said = ",".join(texts)
    if not uavs:
        raise RosterError(201, f"{said}: simulated vehicles stand on the pads of a plan; name one.")
    if said not in {SIMULATED, f"{SIMULATED}:{len(uavs)}"}:
        raise RosterError(
            201,
            f"{said}: the fleet has {len(uavs)} UAVs, so it must be sim or sim:{len(uavs)}.",
        )


def _parse_entry(text: str) -> RosterEntry:
    uav, equals, rest = text.partition("=")
    sysid, at, link_text = rest.partition("@")
    link, _, uid = link_text.partition("#")
    if not (uav and equals and at and sysid.isdigit()):
        raise RosterError(
            201, f'"{text}" is not UAV=SYSID@LINK, for example uav1=1@udpin:0.0.0.0:14550.'
        )
    return RosterEntry(uav, int(sysid), parse_address(link), uid.lower())


# A sender silent for this long has moved or gone.
PEER_SILENT_S = 3.0
# Frames that do not lead to an answer for this long are a matter of keys.
SIGNING_S = 5.0
# Senders remembered per vehicle; more than a few are forgeries.
PEERS_MAX = 8


@dataclass
class _Sender:
    heard_s: float
    uid: str | None = None


@dataclass
class Identity:
    """Senders of one system id on one link, by network address, and their AUTOPILOT_VERSION uid.

    Frames count only from `peer`, the sender believed. A second sender is believed once it reports
    the same uid (the vehicle has a new port after a restart), or once the first has fallen silent.
    With another uid it is a second vehicle: `conflict` says so and stays. `signing` says what is
    wrong with its signatures, or ours, since `signing_s`; `heard_s` is when it was heard first.
    """

    uav: str
    sysid: int
    expected_uid: str = ""
    peer: Peer = None
    conflict: str = ""
    wrong_vehicle: str = ""
    signing: str = ""
    signing_s: float = 0.0
    heard_s: float | None = None
    _senders: dict[Peer, _Sender] = field(default_factory=dict)

    @property
    def known(self) -> bool:
        """Whether the sender believed has told its uid."""
        sender = self._senders.get(self.peer)
        return sender is not None and sender.uid is not None

    def signing_trouble(self, now_s: float) -> str:
        """What keeps a vehicle whose frames arrive from being spoken with, "" if nothing does."""
        lasting = self.signing and now_s - self.signing_s > SIGNING_S
        return f"{self.uav}: {self.signing}." if lasting and not self.known else ""

    def trouble(self, now_s: float) -> str:
        """Why nothing may be sent to it, "" if it may: another vehicle, two of them, or keys."""
        return self.conflict or self.wrong_vehicle or self.signing_trouble(now_s)

    def note_signing(self, trouble: str, now_s: float) -> None:
        """Take note of a frame that is not believed, or that is signed where we have no key."""
        if not self.signing:
            self.signing_s = now_s
        self.signing = trouble

    def unknown_peers(self) -> tuple[Peer, ...]:
        """Senders that have not told their uid yet."""
        return tuple(peer for peer, sender in self._senders.items() if sender.uid is None)

    def heard(self, peer: Peer, now_s: float) -> bool:
        """Take note of a frame; True if its sender is the one believed."""
        sender = self._senders.get(peer)
        if sender is None:
            self._forget(now_s)
            if len(self._senders) >= PEERS_MAX:
                return False
            sender = self._senders[peer] = _Sender(now_s)
        sender.heard_s = now_s
        self.heard_s = now_s if self.heard_s is None else self.heard_s
        if not self._alive(self.peer, now_s):
            self.peer = peer
        return peer == self.peer

    def version(self, peer: Peer, uid: str) -> None:
        """Take note of the uid that a sender reports ("" if it has none)."""
        sender = self._senders.get(peer)
        if sender is None:
            return
        others = {s.uid for p, s in self._senders.items() if p != peer and s.uid is not None}
        if sender.uid is not None and sender.uid != uid:
            others.add(sender.uid)
        sender.uid = uid
        if others - {uid}:
            seen = " and ".join(sorted(others | {uid}))
            self.conflict = (
                f"{self.uav}: two vehicles answer to system id {self.sysid} (uid {seen}). "
                "Switch one off or give it its own SYSID_THISMAV."
            )
        elif others or len(self._senders) == 1:
            self.peer = peer
        if self.expected_uid and uid != self.expected_uid:
            self.wrong_vehicle = (
                f"{self.uav}: the vehicle with system id {self.sysid} has uid {uid or 'none'}, "
                f"the roster says {self.expected_uid}."
            )

    def _alive(self, peer: Peer, now_s: float) -> bool:
        sender = self._senders.get(peer)
        return sender is not None and now_s - sender.heard_s <= PEER_SILENT_S

    def _forget(self, now_s: float) -> None:
        for peer in list(self._senders):
            if peer != self.peer and not self._alive(peer, now_s):
                del self._senders[peer]
