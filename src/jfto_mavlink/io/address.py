"""Names of links: udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT, serial:DEVICE[:BAUD].

And a UDP port to listen on that nothing else is about to take.
"""

from __future__ import annotations

import itertools
import os
import socket
from dataclasses import dataclass

from jfto_mavlink.errors import LinkAddressError, LinkError

KINDS = ("udpin", "udpout", "tcp", "serial")
DEFAULT_BAUD = 57_600


@dataclass(frozen=True)
class LinkAddress:
    """One endpoint. `number` is the port, or the baud rate of a serial line."""

    kind: str
    host: str
    number: int

    def __str__(self) -> str:
        return f"{self.kind}:{self.host}:{self.number}"


def parse_address(text: str) -> LinkAddress:
    """Read a link's name; raises LinkAddressError."""
    kind, _, rest = text.partition(":")
    if kind not in KINDS or not rest:
        raise LinkAddressError(
            101, f'link "{text}": must begin with one of {", ".join(k + ":" for k in KINDS)}'
        )
    host, _, number = rest.rpartition(":")
    if kind == "serial" and (not host or not number.isdigit()):
        return LinkAddress(kind, rest, DEFAULT_BAUD)
    if not host or not number.isdigit() or (not 0 < int(number) < 2**16 and kind != "serial"):
        raise LinkAddressError(101, f'link "{text}": needs HOST:PORT with a port of 1 to 65535.')
    return LinkAddress(kind, host, int(number))


# Below the range from which systems hand out ports by themselves: one of those may be gone again
# between finding and opening it.
LOWEST, HIGHEST = 16_000, 30_000

_CALLS = itertools.count()


def free_udp_port(host: str = "127.0.0.1") -> int:
    """Port that can be bound now; processes begin looking at different ones."""
    count = HIGHEST - LOWEST
    begin = os.getpid() * 97 + next(_CALLS)
    for offset in range(count):
        port = LOWEST + (begin + offset) % count
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind((host, port))
            except OSError:
                continue
        return port
    raise LinkError(102, f"{host}: no free UDP port from {LOWEST} to {HIGHEST}.")
