"""One vehicle on the network: its endpoints, and the lossy links between them and itself."""

from __future__ import annotations

from collections.abc import Sequence

from jfto_msgs_py.errors import InputError, JftoError
from jfto_sim.dialect import mavlink
from jfto_sim.endpoint import Endpoint, Endpoints
from jfto_sim.faults import LinkFaults, LossyPipe
from jfto_sim.vehicle import Vehicle

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
    """One vehicle with its endpoints (texts as of `Endpoints`) and both directions of each.

    `position_ns` is when the newest position that has left it was true, by its UTC; 0 before.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        endpoints: Sequence[str],
        seed: int,
        opening: Endpoints | None = None,
    ) -> None:
        if len(endpoints) > len(vehicle.ports):
            raise InputError(
                f"Vehicle {vehicle.sysid} has {len(vehicle.ports)} ports, not {len(endpoints)}."
            )
        self.vehicle = vehicle
        self.position_ns = 0
        self.endpoints: list[Endpoint] = []
        try:
            opening = opening or Endpoints()
            for text in endpoints:
                self.endpoints.append(opening.open(text))
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
