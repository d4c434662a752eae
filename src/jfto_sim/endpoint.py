"""Where a vehicle's port meets the network: UDP listening, UDP sending, TCP for one client."""

from __future__ import annotations

import socket
from collections.abc import Sequence

from jfto_msgs_py.errors import InputError, JftoError
from jfto_sim.dialect import mavlink
from jfto_sim.faults import LinkFaults, LossyPipe
from jfto_sim.vehicle import Vehicle

_CHUNK = 4096
_BACKLOG_MAX = 1 << 20


def _bound(kind: socket.SocketKind, host: str, port: int) -> socket.socket:
    """A non-blocking socket on an address; closed again where that is taken."""
    sock = socket.socket(socket.AF_INET, kind)
    try:
        sock.setblocking(False)
        if kind is socket.SOCK_STREAM:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind((host, port))
    except OSError:
        sock.close()
        raise
    return sock


def _open(sock: socket.socket) -> bool:
    """Whether the other end still holds the connection; closed on this side too if not."""
    try:
        gone = sock.recv(1, socket.MSG_PEEK) == b""
    except BlockingIOError:
        return True
    except ConnectionError:
        gone = True
    if gone:
        sock.close()
    return not gone


class UdpEndpoint:
    """UDP. Without a remote it answers whoever spoke last; with one it sends there."""

    def __init__(self, host: str, port: int, remote: tuple[str, int] | None = None) -> None:
        self._socket = _bound(socket.SOCK_DGRAM, host, port)
        self._remote = remote

    def sockets(self) -> list[socket.socket]:
        """The one socket."""
        return [self._socket]

    def receive(self) -> list[bytes]:
        """All datagrams that are waiting."""
        chunks: list[bytes] = []
        while True:
            try:
                data, peer = self._socket.recvfrom(_CHUNK)
            except (BlockingIOError, ConnectionError):
                return chunks
            self._remote = peer
            chunks.append(data)

    def send(self, frame: bytes) -> None:
        """One datagram per frame; a full or refused socket loses it, as radio does."""
        if self._remote is None:
            return
        try:
            self._socket.sendto(frame, self._remote)
        except (BlockingIOError, ConnectionError):
            return

    def drop(self) -> None:
        """UDP has no connection to end."""

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    @property
    def address(self) -> tuple[str, int]:
        """Local host and port."""
        host, port = self._socket.getsockname()
        return host, port


class TcpEndpoint:
    """TCP server for one client; a second one connects but hears nothing."""

    def __init__(self, host: str, port: int) -> None:
        self._server = _bound(socket.SOCK_STREAM, host, port)
        self._server.listen(4)
        self._client: socket.socket | None = None
        self._idle: list[socket.socket] = []
        self._backlog = bytearray()

    def sockets(self) -> list[socket.socket]:
        """Server and client."""
        return [self._server] if self._client is None else [self._server, self._client]

    def receive(self) -> list[bytes]:
        """Accept a client; what the client has sent."""
        self._accept()
        chunks: list[bytes] = []
        while self._client is not None:
            try:
                data = self._client.recv(_CHUNK)
            except BlockingIOError:
                break
            except ConnectionError:
                data = b""
            if not data:
                self.drop()
                break
            chunks.append(data)
        return chunks

    def _accept(self) -> None:
        try:
            client, _ = self._server.accept()
        except (BlockingIOError, ConnectionError):
            return
        client.setblocking(False)
        self._idle = [idle for idle in self._idle if _open(idle)]
        if self._client is None:
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._client = client
        else:
            self._idle.append(client)

    def send(self, frame: bytes) -> None:
        """Queue and send; a client that does not read loses the connection's oldest megabyte."""
        if self._client is None:
            return
        self._backlog += frame
        try:
            sent = self._client.send(self._backlog)
        except BlockingIOError:
            sent = 0
        except ConnectionError:
            self.drop()
            return
        del self._backlog[:sent]
        if len(self._backlog) > _BACKLOG_MAX:
            self.drop()

    def drop(self) -> None:
        """End the client's connection."""
        if self._client is not None:
            self._client.close()
        self._client = None
        self._backlog.clear()

    def close(self) -> None:
        """Close everything."""
        self.drop()
        for client in self._idle:
            client.close()
        self._server.close()

    @property
    def address(self) -> tuple[str, int]:
        """Local host and port."""
        host, port = self._server.getsockname()
        return host, port


# A non-blocking byte transport that never raises because of its peer.
Endpoint = UdpEndpoint | TcpEndpoint


def open_endpoint(text: str) -> Endpoint:
    """Bind `tcp:HOST:PORT`, `udp:HOST:PORT` (listening) or `udpto:HOST:PORT` (sending).

    Port 0 takes a free one. Raises InputError for other texts, and where the address is taken.
    """
    kind, _, place = text.partition(":")
    host, _, port = place.partition(":")
    if kind not in ("tcp", "udp", "udpto") or not port.isdigit():
        raise InputError(
            f"Endpoint '{text}' must be tcp:HOST:PORT, udp:HOST:PORT or udpto:HOST:PORT."
        )
    try:
        if kind == "tcp":
            return TcpEndpoint(host, int(port))
        if kind == "udp":
            return UdpEndpoint(host, int(port))
        return UdpEndpoint(host, 0, (host, int(port)))
    except OSError as error:
        raise InputError(
            f"Endpoint {text} cannot be opened: {error}. Choose another port."
        ) from error


# Length of a frame's header, by its first byte.
_HEADER_BYTES = {mavlink.PROTOCOL_MARKER_V1: 6, mavlink.PROTOCOL_MARKER_V2: 10}


def position_ms(frame: bytes) -> int | None:
    """The vehicle's time since power-up in a position that it sends, ms; None in other frames."""
    header = _HEADER_BYTES[frame[0]]
    number = frame[5:6] if frame[0] == mavlink.PROTOCOL_MARKER_V1 else frame[7:10]
    if int.from_bytes(number, "little") != mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT:
        return None
    return int.from_bytes(frame[header : header + 4], "little")


class Station:
    """One vehicle with its endpoints (texts as of `open_endpoint`) and both directions of each.

    `position_ns` is when the newest position that has left it was true, by its UTC; 0 before.
    """

    def __init__(self, vehicle: Vehicle, endpoints: Sequence[str], seed: int) -> None:
        if len(endpoints) > len(vehicle.ports):
            raise InputError(
                f"Vehicle {vehicle.sysid} has {len(vehicle.ports)} ports, not {len(endpoints)}."
            )
        self.vehicle = vehicle
        self.position_ns = 0
        self.endpoints: list[Endpoint] = []
        try:
            for text in endpoints:
                self.endpoints.append(open_endpoint(text))
        except JftoError:
            self.close()
            raise
        self.links = [
            {
                "to": LossyPipe(LinkFaults(), seed * 1000 + 2 * k),
                "from": LossyPipe(LinkFaults(), seed * 1000 + 2 * k + 1),
            }
            for k in range(len(endpoints))
        ]

    def mend(self) -> None:
        """All links clean again."""
        for link in self.links:
            for pipe in link.values():
                pipe.faults = LinkFaults()

    def reboot(self) -> None:
        """Restart the vehicle; connections end."""
        self.vehicle.reboot()
        for endpoint in self.endpoints:
            endpoint.drop()

    def step(self, dt_s: float) -> None:
        """Read, advance, send. Link delays count in the vehicle's time."""
        vehicle = self.vehicle
        now = vehicle.total_s
        for k, endpoint in enumerate(self.endpoints):
            pipe = self.links[k]["to"]
            for chunk in endpoint.receive():
                pipe.put(chunk, now)
            for chunk in pipe.take(now + dt_s):
                vehicle.handle(chunk, k)
        boots = vehicle.boots
        for port, frame in vehicle.advance(dt_s):
            if port < len(self.links):
                self.links[port]["from"].put(frame, vehicle.total_s)
        for k, endpoint in enumerate(self.endpoints):
            for frame in self.links[k]["from"].take(vehicle.total_s):
                endpoint.send(frame)
                at_ms = position_ms(frame)
                if at_ms is not None:
                    self.position_ns = (vehicle.clock.utc_at_boot_us + 1000 * at_ms) * 1000
            if vehicle.boots != boots:
                endpoint.drop()

    def close(self) -> None:
        """Give the sockets back."""
        for endpoint in self.endpoints:
            endpoint.close()
