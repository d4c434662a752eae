"""What goes out regularly or on request: streams, message intervals, single messages."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_sim.clock import Clock
from jfto_sim.commands import Command, CommandHandler
from jfto_sim.dialect import ACCEPTED, DENIED, FAILED, INFO, Message, mavlink
from jfto_sim.ports import MessageHandler, Ports
from jfto_sim.telemetry import MESSAGES, Telemetry

_FASTEST_US = 3000
_FIRST_HEARTBEAT_S = 1.04
_TERRAIN_REQUEST_S = 2.0


def _ids(*names: str) -> tuple[int, ...]:
    return tuple(getattr(mavlink, f"MAVLINK_MSG_ID_{name}") for name in names)


# REQUEST_DATA_STREAM: messages of each stream, in the order in which ArduCopter sends them
_RAW = _ids("RAW_IMU", "SCALED_IMU2", "SCALED_IMU3", "SCALED_PRESSURE", "SCALED_PRESSURE2")
_EXTENDED = _ids(
    "SYS_STATUS", "POWER_STATUS", "MEMINFO", "NAV_CONTROLLER_OUTPUT", "MISSION_CURRENT",
    "GPS_RAW_INT",
)  # fmt: skip
_RC = _ids("SERVO_OUTPUT_RAW", "RC_CHANNELS")
_POSITION = _ids("GLOBAL_POSITION_INT", "LOCAL_POSITION_NED")
_EXTRA1 = _ids("ATTITUDE", "SIMSTATE", "AHRS2")
_EXTRA2 = _ids("VFR_HUD")
_EXTRA3 = _ids(
    "AHRS", "SYSTEM_TIME", "WIND", "TERRAIN_REPORT", "BATTERY_STATUS", "EKF_STATUS_REPORT",
    "VIBRATION", "ESC_TELEMETRY_1_TO_4",
)  # fmt: skip
_STREAMS: dict[int, tuple[int, ...]] = {
    0: (*_EXTRA1, *_POSITION, *_EXTENDED, *_EXTRA2, *_RC, *_RAW, *_EXTRA3),
    1: _RAW,
    2: _EXTENDED,
    3: _RC,
    6: _POSITION,
    10: _EXTRA1,
    11: _EXTRA2,
    12: _EXTRA3,
}
_WITH_TERRAIN = (0, 12)


@dataclass
class Streams:
    """Sends telemetry on the ports as often as each was asked to; heartbeats at once a second."""

    ports: Ports
    clock: Clock
    telemetry: Telemetry

    def __post_init__(self) -> None:
        self.messages: dict[str, MessageHandler] = {"REQUEST_DATA_STREAM": self._request_stream}
        self.commands: dict[int, CommandHandler] = {
            mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: self._get_interval,
            mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_interval,
            mavlink.MAV_CMD_REQUEST_MESSAGE: self._request_message,
            mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: self._capabilities,
        }
        for port in self.ports:
            port.set_interval(mavlink.MAVLINK_MSG_ID_HEARTBEAT, 1.0, _FIRST_HEARTBEAT_S - 1.0)

    @property
    def next_s(self) -> float:
        """When a message is due."""
        return min(port.next_due_s() for port in self.ports)

    def tick(self) -> None:
        """Send what is due."""
        for port in self.ports:
            for message_id in port.pop_due(self.clock.time_s):
                self._send(port.index, message_id)

    def _send(self, port: int, message_id: int) -> None:
        self.ports.send(port, getattr(self.telemetry, MESSAGES[message_id])())

    def _request_stream(self, m: Message, port: int) -> None:
        """Start or stop the messages of a stream on the asking port."""
        rate_hz = m.req_message_rate if m.start_stop == 1 else 0
        period_s = 1.0 / rate_hz if rate_hz > 0 else 0.0
        now = self.clock.time_s
        for message_id in _STREAMS.get(m.req_stream_id, ()):
            self.ports[port].set_interval(message_id, period_s, now)
        if m.req_stream_id in _WITH_TERRAIN:
            request = mavlink.MAVLINK_MSG_ID_TERRAIN_REQUEST
            self.ports[port].set_interval(request, _TERRAIN_REQUEST_S if period_s else 0.0, now)

    def _get_interval(self, c: Command) -> int:
        message_id = c.whole(0)
        known = message_id in MESSAGES
        found = 0
        if known:
            interval = self.ports[c.port].intervals.get(message_id)
            found = -1 if interval is None else round(interval.period_s * 1e6)
        answer = mavlink.MAVLink_message_interval_message(message_id & 0xFFFF, found)
        self.ports.send(c.port, answer)
        return ACCEPTED if known else FAILED

    def _set_interval(self, c: Command) -> int:
        if not (math.isfinite(c.p[0]) and math.isfinite(c.p[1])):
            return DENIED
        message_id, wanted_us = c.whole(0), c.p[1]
        if message_id not in MESSAGES:
            self.ports.text(INFO, f"No ap_message for mavlink id ({message_id})", c.port)
            return DENIED
        period_s = max(wanted_us, _FASTEST_US) * 1e-6 if wanted_us > 0 else 0.0
        if wanted_us == 0 and message_id == mavlink.MAVLINK_MSG_ID_HEARTBEAT:
            period_s = 1.0
        self.ports[c.port].set_interval(message_id, period_s, self.clock.time_s)
        return ACCEPTED

    def _request_message(self, c: Command) -> int:
        message_id = c.whole(0)
        if message_id not in MESSAGES:
            return FAILED
        self._send(c.port, message_id)
        return ACCEPTED

    def _capabilities(self, c: Command) -> int:
        if c.p[0] != 1:
            return FAILED
        self.ports.send(c.port, self.telemetry.autopilot_version())
        return ACCEPTED
