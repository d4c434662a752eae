"""Is a system id one vehicle? Which of several senders with the same id to believe."""

from __future__ import annotations

from dataclasses import dataclass, field

from jfto_mavlink.link.transport import Peer

# A sender silent for this long has moved or gone.
PEER_SILENT_S = 3.0
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
    With another uid it is a second vehicle: `conflict` says so and stays.
    """

    uav: str
    sysid: int
    expected_uid: str = ""
    peer: Peer = None
    conflict: str = ""
    wrong_vehicle: str = ""
    _senders: dict[Peer, _Sender] = field(default_factory=dict)

    @property
    def known(self) -> bool:
        """Whether the sender believed has told its uid."""
        sender = self._senders.get(self.peer)
        return sender is not None and sender.uid is not None

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
