"""Where a vehicle's port meets the network: UDP listening, UDP sending, TCP, or one with others."""

from __future__ import annotations

import socket

from jfto_msgs_py.errors import InputError

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


class SharedEndpoint:
    """One vehicle's seat on an endpoint that several share, as radios of one net do.

    What comes in reaches all of them, whoever it is for; what they send goes out there.
    """

    def __init__(self, medium: UdpEndpoint | TcpEndpoint, seats: list[SharedEndpoint]) -> None:
        self._medium, self._seats = medium, seats
        self._waiting: list[bytes] = []
        seats.append(self)

    def sockets(self) -> list[socket.socket]:
        """Those of the medium, told once."""
        return self._medium.sockets() if self._seats[0] is self else []

    def receive(self) -> list[bytes]:
        """What came in for all since this one last asked."""
        for chunk in self._medium.receive():
            for seat in self._seats:
                seat._waiting.append(chunk)
        waiting, self._waiting = self._waiting, []
        return waiting

    def send(self, frame: bytes) -> None:
        """To whoever listens to the medium."""
        self._medium.send(frame)

    def drop(self) -> None:
        """One vehicle's restart ends nobody's connection."""

    def close(self) -> None:
        """Leave; the last one closes the medium."""
        if self in self._seats:
            self._seats.remove(self)
            if not self._seats:
                self._medium.close()

    @property
    def address(self) -> tuple[str, int]:
        """Local host and port."""
        return self._medium.address


# A non-blocking byte transport that never raises because of its peer.
Endpoint = UdpEndpoint | TcpEndpoint | SharedEndpoint


class Endpoints:
    """Opens endpoints; `shared:` before a text lets all that name it have one between them."""

    def __init__(self) -> None:
        self._shared: dict[str, tuple[UdpEndpoint | TcpEndpoint, list[SharedEndpoint]]] = {}

    def open(self, text: str) -> Endpoint:
        """An endpoint of its own, or a seat on a shared one; raises as `open_endpoint` does."""
        kind, _, rest = text.partition(":")
        if kind != "shared":
            return open_endpoint(text)
        if rest not in self._shared:
            self._shared[rest] = (open_endpoint(rest), [])
        return SharedEndpoint(*self._shared[rest])


def open_endpoint(text: str) -> UdpEndpoint | TcpEndpoint:
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
