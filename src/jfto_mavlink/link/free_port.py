"""A UDP port to listen on that nothing else is about to take."""

from __future__ import annotations

import itertools
import os
import socket

from jfto_mavlink.errors import LinkError

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
