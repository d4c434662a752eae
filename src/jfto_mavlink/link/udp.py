"""UDP links: udpin listens and answers whoever spoke, udpout speaks to one address."""

from __future__ import annotations

import socket

from jfto_mavlink.errors import LinkError
from jfto_mavlink.link.address import LinkAddress
from jfto_mavlink.link.transport import Peer, Received

# Room for a burst of full-rate telemetry from many vehicles while the process is descheduled.
RECEIVE_BUFFER = 4 * 1024 * 1024
DATAGRAMS_PER_CALL = 1000


class UdpTransport:
    """One UDP socket. On `udpin`, `send` needs the peer; on `udpout` the address is fixed."""

    def __init__(self, address: LinkAddress) -> None:
        self.dropped = 0
        try:
            family, kind, _, _, target = socket.getaddrinfo(
                address.host, address.number, type=socket.SOCK_DGRAM
            )[0]
        except OSError as error:
            raise LinkError(102, f"{address}: unknown host: {error.strerror}.") from error
        self._socket = socket.socket(family, kind)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
        self._socket.setblocking(False)
        try:
            if address.kind == "udpin":
                self._socket.bind(target)
        except OSError as error:
            self._socket.close()
            raise LinkError(102, f"{address}: cannot be opened: {error.strerror}.") from error
        self._target = None if address.kind == "udpin" else target

    def fileno(self) -> int | None:
        """Descriptor to wait on."""
        return self._socket.fileno()

    def receive(self) -> list[Received]:
        """Datagrams waiting, with their senders."""
        datagrams: list[Received] = []
        while len(datagrams) < DATAGRAMS_PER_CALL:
            try:
                data, peer = self._socket.recvfrom(65_536)
            except BlockingIOError:
                break
            except ConnectionError:
                # Linux reports here that an earlier datagram met no listener.
                continue
            except OSError:
                # The interface is down for now; heartbeats stop, which is told as a lost link.
                self.dropped += 1
                break
            datagrams.append((None if self._target else peer, data))
        return datagrams

    def send(self, data: bytes, peer: Peer) -> None:
        """Send one datagram; without an address, or with a full socket, it is dropped."""
        target = self._target or peer
        if target is None:
            self.dropped += 1
            return
        try:
            self._socket.sendto(data, target)
        except OSError:
            self.dropped += 1

    def flush(self) -> bool:
        """Nothing is ever queued."""
        return False

    def maintain(self, now_s: float) -> None:
        """Nothing to do: a datagram socket does not go down."""

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
