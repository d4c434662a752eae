"""A switch between network interfaces that loses and delays frames, where tc has no netem.

    python lossy_switch.py LOSS DELAY_S SEED INTERFACE...

Prints "ready" once it forwards. Raw sockets with virtio headers: those carry the state of check
sums, which virtual interfaces leave to be computed by hardware that is not there.
"""

from __future__ import annotations

import heapq
import random
import select
import socket
import sys
import time

SOL_PACKET, PACKET_VNET_HDR = 263, 15
ETH_P_ALL = 3
LARGEST = 1 << 17


def main(loss: float, delay_s: float, seed: int, interfaces: list[str]) -> None:
    """Forward each frame to all other interfaces, for ever."""
    rng = random.Random(seed)
    ports = []
    for interface in interfaces:
        port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW)
        port.setsockopt(SOL_PACKET, PACKET_VNET_HDR, 1)
        port.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        port.bind((interface, ETH_P_ALL))
        ports.append(port)
    print("ready", flush=True)
    waiting: list[tuple[float, int, bytes, socket.socket]] = []
    count = 0
    while True:
        wait_s = max(waiting[0][0] - time.monotonic(), 0.0) if waiting else None
        for port in select.select(ports, [], [], wait_s)[0]:
            frame, address = port.recvfrom(LARGEST)
            if address[2] == socket.PACKET_OUTGOING:
                continue
            for other in ports:
                if other is not port and rng.random() >= loss:
                    count += 1
                    heapq.heappush(waiting, (time.monotonic() + delay_s, count, frame, other))
        while waiting and waiting[0][0] <= time.monotonic():
            _, _, frame, other = heapq.heappop(waiting)
            other.send(frame)


if __name__ == "__main__":
    main(float(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3]), sys.argv[4:])
