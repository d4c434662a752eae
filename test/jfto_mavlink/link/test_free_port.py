"""Finding a port to listen on."""

from __future__ import annotations

import socket

from jfto_mavlink.link.free_port import HIGHEST, LOWEST, free_udp_port


def test_a_port_in_use_is_not_offered() -> None:
    """Every port offered can be bound, and stays clear of those the system hands out."""
    held = []
    try:
        for _ in range(20):
            port = free_udp_port()
            assert LOWEST <= port < HIGHEST
            sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            held.append(sock)
            sock.bind(("127.0.0.1", port))
    finally:
        for sock in held:
            sock.close()
    assert len(held) == 20
