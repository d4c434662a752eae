"""A plain ground station in simulated time: talks to one `Vehicle` on one port, nothing lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from jfto_msgs_py.errors import JftoError
from jfto_sim.dialect import Message, mavlink
from jfto_sim.mission.items import Item
from jfto_sim.vehicle import Vehicle

READY_S = 43.0
_SLICE_S = 0.05
_HEARTBEAT_S = 1.0


class PilotError(JftoError):
    """The vehicle did not do what it was asked."""


@dataclass(frozen=True)
class Heard:
    """A message and the vehicle time at which it had arrived."""

    time_s: float
    message: Message


class Pilot:
    """Sends heartbeats, commands and missions; `heard` is everything the vehicle said."""

    def __init__(
        self, vehicle: Vehicle, port: int = 0, *, system: int = 255, component: int = 190
    ) -> None:
        self.vehicle, self.port = vehicle, port
        self.heard: list[Heard] = []
        self.codec = mavlink.MAVLink(None, system, component)
        self._codec_in = mavlink.MAVLink(None)
        self._codec_in.robust_parsing = True
        self._beat_s = 0.0
        self.beating = True

    def send(self, message: Message) -> None:
        """One message, framed and numbered."""
        frame = message.pack(self.codec)
        self.codec.seq = (self.codec.seq + 1) % 256
        self.vehicle.handle(bytes(frame), self.port)

    def run(self, seconds: float) -> list[Heard]:
        """Let time pass; returns what was heard meanwhile."""
        first, left = len(self.heard), seconds
        while left > 1e-9:
            step = min(left, _SLICE_S)
            left -= step
            if self.beating and self.vehicle.total_s >= self._beat_s:
                self._beat_s = self.vehicle.total_s + _HEARTBEAT_S
                self.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
            for port, frame in self.vehicle.advance(step):
                if port != self.port:
                    continue
                for message in self._codec_in.parse_buffer(frame) or []:
                    self.heard.append(Heard(self.vehicle.time_s, message))
        return self.heard[first:]

    def wait(self, what: Callable[[Message], bool], limit_s: float = 5.0) -> Heard:
        """Run until a message that fits is heard; raises PilotError if none comes in time."""
        end = self.vehicle.total_s + limit_s
        while self.vehicle.total_s < end:
            for heard in self.run(_SLICE_S):
                if what(heard.message):
                    return heard
        raise PilotError(f"Nothing fitting was heard from the vehicle within {limit_s:g} s.")

    def wait_type(self, kind: str, limit_s: float = 5.0) -> Heard:
        """Run until a message of a type is heard."""
        return self.wait(lambda m: m.get_type() == kind, limit_s)

    def command(self, number: int, *params: float) -> int:
        """COMMAND_LONG; returns the result of its acknowledgement."""
        values = [*params, *([0.0] * (7 - len(params)))]
        self.send(mavlink.MAVLink_command_long_message(self.vehicle.sysid, 1, number, 0, *values))
        ack = self.wait(lambda m: m.get_type() == "COMMAND_ACK" and m.command == number)
        return int(ack.message.result)

    def set_parameter(self, name: str, value: float) -> None:
        """PARAM_SET, waiting for its echo."""
        self.send(mavlink.MAVLink_param_set_message(self.vehicle.sysid, 1, name.encode(), value, 9))
        self.wait(lambda m: m.get_type() == "PARAM_VALUE" and m.param_id == name)

    def every(self, message_id: int, period_s: float) -> None:
        """Ask for a message at a rate."""
        self.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, message_id, period_s * 1e6)

    def upload(self, items: Sequence[Item], kind: int = 0) -> int:
        """Upload items (item 0 of a mission is home); returns the MISSION_ACK's type."""
        sysid = self.vehicle.sysid
        self.send(mavlink.MAVLink_mission_count_message(sysid, 1, len(items), kind))
        while True:
            heard = self.wait(lambda m: m.get_type() in ("MISSION_REQUEST", "MISSION_ACK"), 10.0)
            m = heard.message
            if m.get_type() == "MISSION_ACK":
                return int(m.type)
            self.send(self.item_message(items[m.seq], m.seq, kind))

    def item_message(self, item: Item, seq: int, kind: int = 0) -> Message:
        """MISSION_ITEM_INT of an item."""
        return mavlink.MAVLink_mission_item_int_message(
            self.vehicle.sysid, 1, seq, item.frame, item.command, 0, 1, *item.params,
            item.x, item.y, item.z_m, kind,
        )  # fmt: skip

    def download(self, kind: int = 0) -> list[Message]:
        """All items as MISSION_ITEM_INT."""
        sysid = self.vehicle.sysid
        self.send(mavlink.MAVLink_mission_request_list_message(sysid, 1, kind))
        count = self.wait_type("MISSION_COUNT").message.count
        items = []
        for seq in range(count):
            self.send(mavlink.MAVLink_mission_request_int_message(sysid, 1, seq, kind))
            items.append(self.wait_type("MISSION_ITEM_INT").message)
        return items

    def ready(self) -> None:
        """Wait until the vehicle may be armed."""
        self.run(max(0.0, READY_S - self.vehicle.time_s))

    def take_off(self, height_m: float) -> None:
        """GUIDED, arm, climb and settle."""
        self.ready()
        for number, params in ((176, (1, 4)), (400, (1,)), (22, (0, 0, 0, 0, 0, 0, height_m))):
            if self.command(number, *params) != 0:
                raise PilotError(f"Command {number} was refused before the takeoff.")
        end = self.vehicle.total_s + 20.0 + height_m
        while self.vehicle.total_s < end:
            self.run(1.0)
            if abs(self.vehicle.flight.position.from_home_m[2] - height_m) < 0.3:
                self.run(5.0)
                return
        raise PilotError(f"The vehicle did not reach {height_m:g} m.")

    def texts(self) -> list[str]:
        """All STATUSTEXT heard so far."""
        return [h.message.text for h in self.heard if h.message.get_type() == "STATUSTEXT"]
