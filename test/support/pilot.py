"""A plain ground station: talks to one `Vehicle` on one port in simulated time, nothing lost.

A test that does not ask it for `vehicle` can be given a `LivePilot` instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from jfto_msgs_py.errors import JftoError
from jfto_sim.dialect import Message, mavlink
from jfto_sim.mission.items import Item
from jfto_sim.vehicle import Vehicle

READY_S = 43.0
SLICE_S = 0.05
_HEARTBEAT_S = 1.0
# the real height estimate wanders more than the simulated one
_SETTLED_M = 0.5


class PilotError(JftoError):
    """The vehicle did not do what it was asked."""


@dataclass(frozen=True)
class Heard:
    """A message and the vehicle time at which it had arrived."""

    time_s: float
    message: Message


class Pilot:
    """Sends heartbeats, commands and missions; `heard` is everything the vehicle said."""

    real = False

    def __init__(
        self, vehicle: Vehicle, port: int = 0, *, system: int = 255, component: int = 190
    ) -> None:
        self.vehicle, self.port = vehicle, port
        self._listen(system, component)

    def _listen(self, system: int, component: int) -> None:
        self.heard: list[Heard] = []
        self.codec = mavlink.MAVLink(None, system, component)
        self._codec_in = mavlink.MAVLink(None)
        self._codec_in.robust_parsing = True
        self._beat_s = 0.0
        self.beating = True

    # --- what the two kinds of vehicle do in their own way ---

    @property
    def sysid(self) -> int:
        """The vehicle's system id."""
        return self.vehicle.sysid

    @property
    def now_s(self) -> float:
        """The vehicle's time."""
        return self.vehicle.total_s

    def _put(self, frame: bytes) -> None:
        self.vehicle.handle(frame, self.port)

    def _pass(self, step_s: float) -> Iterable[bytes]:
        """Let time pass; what came meanwhile."""
        return [frame for port, frame in self.vehicle.advance(step_s) if port == self.port]

    def ready(self) -> None:
        """Wait until the vehicle may be armed."""
        self.run(max(0.0, READY_S - self.vehicle.time_s))

    # --- the rest is the same ---

    def send(self, message: Message) -> None:
        """One message, framed and numbered."""
        frame = message.pack(self.codec)
        self.codec.seq = (self.codec.seq + 1) % 256
        self._put(bytes(frame))

    def run(self, seconds: float) -> list[Heard]:
        """Let time pass; returns what was heard meanwhile."""
        first, end = len(self.heard), self.now_s + seconds
        while end - self.now_s > 1e-9:
            self._go_on(min(end - self.now_s, SLICE_S))
        return self.heard[first:]

    def _go_on(self, step_s: float) -> None:
        """A heartbeat if it is due, a moment of time, and what came in it."""
        if self.beating and self.now_s >= self._beat_s:
            self._beat_s = self.now_s + _HEARTBEAT_S
            self.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
        for frame in self._pass(step_s):
            for message in self._codec_in.parse_buffer(frame) or []:
                if message.get_type() != "BAD_DATA":
                    self._take(message)

    def _take(self, message: Message) -> None:
        self.heard.append(Heard(self.now_s, message))

    def wait(self, what: Callable[[Message], bool], limit_s: float = 5.0) -> Heard:
        """Run until a message that fits is heard; raises PilotError if none comes in time."""
        end = self.now_s + limit_s
        while self.now_s < end:
            for heard in self.run(SLICE_S):
                if what(heard.message):
                    return heard
        raise PilotError(f"Nothing fitting was heard from the vehicle within {limit_s:g} s.")

    def wait_type(self, kind: str, limit_s: float = 5.0) -> Heard:
        """Run until a message of a type is heard."""
        return self.wait(lambda m: m.get_type() == kind, limit_s)

    def command(self, number: int, *params: float) -> int:
        """COMMAND_LONG; returns the result of its acknowledgement."""
        values = [*params, *([0.0] * (7 - len(params)))]
        self.send(mavlink.MAVLink_command_long_message(self.sysid, 1, number, 0, *values))
        ack = self.wait(lambda m: m.get_type() == "COMMAND_ACK" and m.command == number)
        return int(ack.message.result)

    def set_parameter(self, name: str, value: float) -> None:
        """PARAM_SET, waiting for its echo."""
        self.send(mavlink.MAVLink_param_set_message(self.sysid, 1, name.encode(), value, 9))
        self.wait(lambda m: m.get_type() == "PARAM_VALUE" and m.param_id == name)

    def parameter(self, name: str) -> float:
        """A parameter's value."""
        self.send(mavlink.MAVLink_param_request_read_message(self.sysid, 1, name.encode(), -1))
        heard = self.wait(lambda m: m.get_type() == "PARAM_VALUE" and m.param_id == name)
        return float(heard.message.param_value)

    def every(self, message_id: int, period_s: float) -> None:
        """Ask for a message at a rate."""
        self.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, message_id, period_s * 1e6)

    def upload(self, items: Sequence[Item], kind: int = 0) -> int:
        """Upload items (item 0 of a mission is home); returns the MISSION_ACK's type."""
        sysid = self.sysid
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
            self.sysid, 1, seq, item.frame, item.command, 0, 1, *item.params,
            item.x, item.y, item.z_m, kind,
        )  # fmt: skip

    def download(self, kind: int = 0) -> list[Message]:
        """All items as MISSION_ITEM_INT."""
        sysid = self.sysid
        self.send(mavlink.MAVLink_mission_request_list_message(sysid, 1, kind))
        count = self.wait_type("MISSION_COUNT").message.count
        items = []
        for seq in range(count):
            self.send(mavlink.MAVLink_mission_request_int_message(sysid, 1, seq, kind))
            items.append(self.wait_type("MISSION_ITEM_INT").message)
        return items

    def watch(self) -> None:
        """Ask for what `height_m`, `place_m` and `battery` go by."""
        for name in ("GLOBAL_POSITION_INT", "LOCAL_POSITION_NED", "SYS_STATUS"):
            self.every(getattr(mavlink, f"MAVLINK_MSG_ID_{name}"), 0.2)

    def order(self, number: int, *params: float) -> None:
        """A command that must be accepted; raises PilotError where it is not."""
        result = self.command(number, *params)
        if result != mavlink.MAV_RESULT_ACCEPTED:
            raise PilotError(
                f"Command {number} {params} was answered {result}: {self.texts()[-5:]}"
            )

    def take_off(self, height_m: float) -> None:
        """GUIDED, arm, climb and settle."""
        self.ready()
        self.watch()
        for number, params in ((176, (1, 4)), (400, (1,)), (22, (0, 0, 0, 0, 0, 0, height_m))):
            if self.command(number, *params) != 0:
                raise PilotError(f"Command {number} was refused before the takeoff.")
        end = self.now_s + 20.0 + height_m
        while self.now_s < end:
            self.run(1.0)
            if abs(self.height_m - height_m) < _SETTLED_M:
                self.run(5.0)
                return
        raise PilotError(f"The vehicle did not reach {height_m:g} m.")

    # --- what the vehicle last said of itself ---

    def last(self, kind: str) -> Message:
        """The newest message of a type; waits for one where there is none yet."""
        for heard in reversed(self.heard):
            if heard.message.get_type() == kind:
                return heard.message
        return self.wait_type(kind).message

    @property
    def mode(self) -> int:
        """Number of the flight mode."""
        return int(self.last("HEARTBEAT").custom_mode)

    @property
    def armed(self) -> bool:
        """Whether the motors run."""
        return bool(self.last("HEARTBEAT").base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)

    @property
    def height_m(self) -> float:
        """Metres above home."""
        return float(self.last("GLOBAL_POSITION_INT").relative_alt) / 1000.0

    @property
    def place_m(self) -> tuple[float, float]:
        """Metres east and north of where it powered up."""
        place = self.last("LOCAL_POSITION_NED")
        return float(place.y), float(place.x)

    @property
    def speed_mps(self) -> float:
        """Over the ground."""
        moving = self.last("LOCAL_POSITION_NED")
        return math.hypot(moving.vx, moving.vy)

    @property
    def charge_percent(self) -> int:
        """What the vehicle believes is left in its battery."""
        return int(self.last("SYS_STATUS").battery_remaining)

    def wait_until(self, what: Callable[[], bool], limit_s: float) -> None:
        """Run until something is so, looked at with each position; raises PilotError."""
        self.wait(lambda m: m.get_type() == "GLOBAL_POSITION_INT" and what(), limit_s)

    def wait_mode(self, number: int, limit_s: float = 5.0) -> None:
        """Run until a heartbeat shows a flight mode."""
        self.wait(lambda m: m.get_type() == "HEARTBEAT" and m.custom_mode == number, limit_s)

    def wait_text(self, text: str, limit_s: float = 5.0) -> Heard:
        """Run until a STATUSTEXT that begins with `text` is heard."""
        return self.wait(
            lambda m: m.get_type() == "STATUSTEXT" and m.text.startswith(text), limit_s
        )

    def texts(self) -> list[str]:
        """All STATUSTEXT heard so far."""
        return [h.message.text for h in self.heard if h.message.get_type() == "STATUSTEXT"]
