"""Links with one other end and an order of bytes: TCP clients and serial lines."""

from __future__ import annotations

import os
import socket
import termios
from abc import ABC, abstractmethod

import serial

from jfto_mavlink.errors import LinkError
from jfto_mavlink.link.address import LinkAddress
from jfto_mavlink.link.transport import Peer, Received

REOPEN_EVERY_S = 1.0
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
        self._next_try_s = now_s + REOPEN_EVERY_S
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
