"""Bytes of a link in and out that never block: UDP sockets, TCP clients and serial lines."""

from __future__ import annotations

import os
import socket
import termios
from abc import ABC, abstractmethod
from typing import Protocol

import serial

from jfto_mavlink.errors import LinkError
from jfto_mavlink.io.address import LinkAddress
from jfto_msgs_py.retry import Retry

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


REOPEN = Retry(first_s=1.0, ceiling_s=1.0)
# About a second of a fast telemetry radio; older bytes are worth less than newer ones.
QUEUE_BYTES = 16_384
READ_BYTES = 65_536


class StreamTransport(ABC):
    """A byte stream that is opened again whenever it breaks."""

    def __init__(self, address: LinkAddress) -> None:
        self.address = address
        self.dropped = 0
        self.reopened = -1
        self._queue = bytearray()
        self._fd: int | None = None
        self._next_try_s = float("-inf")

    def fileno(self) -> int | None:
        """Descriptor to wait on, None while the link is down."""
        return self._fd

    def receive(self) -> list[Received]:
        """Bytes waiting; an end of file or an error takes the link down."""
        if self._fd is None:
            return []
        try:
            data = os.read(self._fd, READ_BYTES)
        except BlockingIOError:
            return []
        except OSError:
            data = b""
        if not data:
            self._down()
            return []
        return [(None, data)]

    def send(self, data: bytes, peer: Peer) -> None:  # noqa: ARG002
        """Queue whole frames only, then send what the line takes."""
        if self._fd is None or len(self._queue) + len(data) > QUEUE_BYTES:
            self.dropped += 1
            return
        self._queue += data
        self.flush()

    def flush(self) -> bool:
        """Send what the line takes; True while something is left."""
        if self._fd is None or not self._queue:
            return False
        try:
            sent = os.write(self._fd, self._queue)
        except BlockingIOError:
            return True
        except OSError:
            self._down()
            return False
        del self._queue[:sent]
        return bool(self._queue)

    def maintain(self, now_s: float) -> None:
        """Open the link if it is down, at most once a second."""
        if self._fd is not None or now_s < self._next_try_s:
            return
        self._next_try_s = now_s + REOPEN.first_s
        self._fd = self._open()
        if self._fd is not None:
            self.reopened += 1

    def close(self) -> None:
        """Close the link for good."""
        self._down()
        self._next_try_s = float("inf")

    def _down(self) -> None:
        if self._fd is not None:
            self._shut()
        self._fd = None
        self._queue.clear()

    @abstractmethod
    def _open(self) -> int | None:
        """Descriptor of the opened link, None if the other end is not there yet."""

    @abstractmethod
    def _shut(self) -> None:
        """Close what `_open` opened."""


class TcpTransport(StreamTransport):
    """TCP client. Connecting is waited for in the background; a refusal is tried again."""

    _socket: socket.socket

    def _open(self) -> int | None:
        try:
            family, kind, _, _, target = socket.getaddrinfo(
                self.address.host, self.address.number, type=socket.SOCK_STREAM
            )[0]
        except OSError as error:
            if self.reopened >= 0:
                # The name was known before: the name server is away, perhaps with the link.
                return None
            raise LinkError(102, f"{self.address}: unknown host: {error.strerror}.") from error
        self._socket = socket.socket(family, kind)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            self._socket.connect(target)
        except BlockingIOError:
            return self._socket.fileno()
        except OSError:
            self._socket.close()
            return None
        return self._socket.fileno()

    def _shut(self) -> None:
        self._socket.close()

    def receive(self) -> list[Received]:
        """Bytes waiting; a connection still being made has none."""
        try:
            self._socket.getpeername()
        except OSError:
            if self._fd is not None and self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
                self._down()
            return []
        return super().receive()


class SerialTransport(StreamTransport):
    """Serial line, 8N1, without flow control."""

    _port: serial.Serial

    def _open(self) -> int | None:
        try:
            self._port = serial.Serial(self.address.host, self.address.number, timeout=0)
        except (OSError, ValueError):
            return None
        fd = self._port.fileno()
        os.set_blocking(fd, False)
        # With pyserial's VMIN of 0 a silent line reads like an unplugged one.
        attributes = termios.tcgetattr(fd)
        attributes[6][termios.VMIN] = 1
        termios.tcsetattr(fd, termios.TCSANOW, attributes)
        return fd

    def _shut(self) -> None:
        self._port.close()
