"""What every kind of link offers: bytes in and out that never block."""

from __future__ import annotations

from typing import Protocol

# Where a datagram came from or goes to; None on links with one other end.
Peer = tuple[str, int] | None
Received = tuple[Peer, bytes]


class Transport(Protocol):
    """A link's bytes. No method ever waits; what cannot be sent is dropped and counted."""

    dropped: int

    def fileno(self) -> int | None:
        """Descriptor to wait on, None while the link is down."""

    def receive(self) -> list[Received]:
        """Everything that has arrived."""

    def send(self, data: bytes, peer: Peer) -> None:
        """Send, or queue what the line cannot take yet."""

    def flush(self) -> bool:
        """Send what is queued; True while something is left."""

    def maintain(self, now_s: float) -> None:
        """Open the link again if it is down and the time has come."""

    def close(self) -> None:
        """Give the endpoint back."""
