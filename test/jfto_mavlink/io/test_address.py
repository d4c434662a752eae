"""Names of links, and finding a port to listen on."""

from __future__ import annotations

import socket

import pytest

from jfto_mavlink.errors import LinkAddressError
from jfto_mavlink.io.address import HIGHEST, LOWEST, LinkAddress, free_udp_port, parse_address


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("udpin:0.0.0.0:14550", LinkAddress("udpin", "0.0.0.0", 14550)),
        ("udpout:10.0.0.2:14550", LinkAddress("udpout", "10.0.0.2", 14550)),
        ("tcp:localhost:5760", LinkAddress("tcp", "localhost", 5760)),
        ("serial:/dev/ttyUSB0:921600", LinkAddress("serial", "/dev/ttyUSB0", 921600)),
        ("serial:/dev/ttyACM0", LinkAddress("serial", "/dev/ttyACM0", 57600)),
    ],
)
def test_every_kind_of_link_is_read(text, address):
    """Kind, place and number; serial lines default to 57600 baud."""
    assert parse_address(text) == address


@pytest.mark.parametrize(
    "text",
    ["", "udp:1.2.3.4:5", "udpin:", "udpin:14550", "tcp:host:0", "tcp:host:70000", "tcp:h:x"],
)
def test_a_wrong_name_is_refused_with_the_name_in_it(text):
    """The message quotes what was given."""
    with pytest.raises(LinkAddressError, match="link"):
        parse_address(text)


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
