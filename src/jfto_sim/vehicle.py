"""One ArduCopter-like vehicle as a pure state machine: no sockets, no wall clock, seeded.

`handle` takes bytes heard on a port, `advance` moves the vehicle's clock and returns the frames
sent meanwhile. What came in is looked at every 5 ms, as the autopilot's own loop does; the body
moves in steps of 20 ms.
"""

from __future__ import annotations

import math
from collections import deque

from jfto_sim import dispatch, streams, telemetry
from jfto_sim.arming import Arming
from jfto_sim.battery import Battery
from jfto_sim.boot import Boot
from jfto_sim.camera import Camera
from jfto_sim.clock import Clock
from jfto_sim.commands import Commands
from jfto_sim.config import VehicleConfig
from jfto_sim.dialect import TEXT_LENGTH, WARNING, Message, mavlink
from jfto_sim.estimator import Estimator
from jfto_sim.failsafe import Failsafes
from jfto_sim.flight import Flight
from jfto_sim.geodesy import UNITS_PER_DEGREE
from jfto_sim.mission.protocol import MissionProtocol
from jfto_sim.mission.store import Store
from jfto_sim.modes.auto import Auto
from jfto_sim.modes.base import FlightMode
from jfto_sim.modes.guided import Guided
from jfto_sim.modes.numbers import MODE_NAMES, Mode
from jfto_sim.modes.rtl import Rtl
from jfto_sim.modes.simple import Brake, Land, Loiter, Manual
from jfto_sim.parameter_protocol import ParameterProtocol
from jfto_sim.params import Parameters
from jfto_sim.port import Port
from jfto_sim.signing import SigningKey

Frame = tuple[int, bytes]

LOOP_S = 0.005
STEP_S = 0.02
_WATCH_S = 0.1
_FIRST_HEARTBEAT_S = 1.04
_TIMESYNC_FIRST_S, _TIMESYNC_EVERY_S = 10.0018, 10.00266
_DARK_AFTER_REBOOT_S = 0.3
_INBOX_MAX = 20_000
_NOT_HELD = ("COMMAND_ACK", "MESSAGE_INTERVAL")


class Vehicle(Clock, Flight):
    """A vehicle with its persistent storage; `Flight` holds what it knows about its own motion."""

    def __init__(self, config: VehicleConfig | None = None) -> None:
        self.config = config or VehicleConfig()
        overrides = {"SYSID_THISMAV": float(self.config.sysid), **self.config.parameters}
        self.params = Parameters(overrides)
        self.store = Store()
        self.key = SigningKey()
        self.boots = 0
        self.dead = False
        self.origin = (
            round(self.config.home_lat_deg * UNITS_PER_DEGREE),
            round(self.config.home_lon_deg * UNITS_PER_DEGREE),
        )
        self.utc_offset_us = self.config.utc_at_boot_us
        self.total_s = 0.0
        self.clock_drift_ppm = self.config.clock_drift_ppm
        self.runtime_base_s = 0
        self._out: list[Frame] = []
        self._held: list[tuple[int, Message]] | None = None
        self._power_up()

    def _power_up(self) -> None:
        """Everything that a restart forgets."""
        self.boots += 1
        self.time_s = 0.0
        self._dark_s = 0.0
        self.sysid = int(self.params["SYSID_THISMAV"])
        self.ports = [
            Port(k, self.sysid, self.key, mavlink1=self.params[f"SERIAL{k}_PROTOCOL"] == 1)
            for k in range(self.config.port_count)
        ]
        self._inbox: deque[tuple[int, bytes]] = deque(maxlen=_INBOX_MAX)
        self.told_of_old_request = False
        self.estimator = Estimator(self.params)
        self.battery = Battery(self.params)
        self.reset_motion()
        self.mission_protocol = MissionProtocol(self)
        self.parameter_protocol = ParameterProtocol(self)
        self.commands = Commands(self)
        self.auto, self.guided, self.land = Auto(self), Guided(self), Land(self)
        self.modes: dict[int, FlightMode] = {
            Mode.STABILIZE: Manual(self, Mode.STABILIZE),
            Mode.ALT_HOLD: Manual(self, Mode.ALT_HOLD),
            Mode.AUTO: self.auto,
            Mode.GUIDED: self.guided,
            Mode.LOITER: Loiter(self),
            Mode.RTL: Rtl(self),
            Mode.LAND: self.land,
            Mode.BRAKE: Brake(self),
        }
        self.mode = self.modes[Mode.STABILIZE]
        self.camera = Camera(self)
        self.arming, self.failsafes, self.boot = Arming(self), Failsafes(self), Boot(self)
        self._next_step_s, self._next_watch_s = STEP_S, _WATCH_S
        self._next_timesync_s = _TIMESYNC_FIRST_S
        for port in self.ports:
            port.set_interval(mavlink.MAVLINK_MSG_ID_HEARTBEAT, 1.0, _FIRST_HEARTBEAT_S - 1.0)

    # --- in and out ---

    def handle(self, data: bytes, port: int = 0) -> None:
        """Bytes heard on a port; answers come out of `advance` up to 5 ms later."""
        if not self.dead and self._dark_s <= 0.0:
            self._inbox.append((port, bytes(data)))

    def advance(self, dt_s: float) -> list[Frame]:
        """Let `dt_s` seconds pass; returns the (port, frame) pairs sent meanwhile, in order."""
        self.total_s += dt_s
        own_s = dt_s * (1.0 + self.clock_drift_ppm * 1e-6)
        if self.dead:
            return []
        if self._dark_s > 0.0:
            self._dark_s -= own_s
            if self._dark_s > 0.0:
                return []
            own_s, self._dark_s = -self._dark_s, 0.0
        end = self.time_s + own_s
        while self.time_s < end and self._dark_s <= 0.0:
            self.time_s = min(end, self._next_event_s())
            self._run_due()
        frames, self._out = self._out, []
        return frames

    def _next_event_s(self) -> float:
        times = [self._next_step_s, self.boot.next_s, self.arming.next_s, self._next_timesync_s]
        times += [self.parameter_protocol.next_s, self.mission_protocol.next_s]
        times += [port.next_due_s() for port in self.ports]
        if self._inbox:
            times.append((math.floor(self.time_s / LOOP_S + 1e-6) + 1) * LOOP_S)
        return max(min(times), self.time_s)

    def _run_due(self) -> None:
        now = self.time_s + 1e-9
        if self._inbox and abs(now / LOOP_S - round(now / LOOP_S)) < 1e-4:
            self._read_inbox()
            if self._dark_s > 0.0:
                return
        self.boot.tick()
        self.arming.tick()
        self.parameter_protocol.tick()
        self.mission_protocol.tick()
        if now >= self._next_step_s:
            self._next_step_s += STEP_S
            self.step_motion(STEP_S)
        if now >= self._next_watch_s:
            self._next_watch_s += _WATCH_S
            self.failsafes.tick()
        if now >= self._next_timesync_s:
            self._next_timesync_s += _TIMESYNC_EVERY_S
            self.broadcast(telemetry.timesync(self), everywhere=True)
        for port in self.ports:
            for message_id in port.pop_due(self.time_s):
                self.send_now(port.index, message_id)

    def _read_inbox(self) -> None:
        while self._inbox:
            index, data = self._inbox.popleft()
            for message in self.ports[index].decode(data):
                dispatch.take(self, message, index)
                if self._dark_s > 0.0:
                    self._inbox.clear()
                    return

    def hold_back(self) -> None:
        """Keep what is sent from now on until `release`: an acknowledgement goes out first."""
        self._held = []

    def release(self) -> None:
        """Send what was held back."""
        held, self._held = self._held or [], None
        for port, message in held:
            self.send(port, message)

    def send(self, port: int, message: Message) -> None:
        """Send a message on one port."""
        if self._held is not None and message.get_type() not in _NOT_HELD:
            self._held.append((port, message))
            return
        if self.key.active:
            self.key.advance_to(self.utc_us)
        frame = self.ports[port].encode(message)
        if frame:
            self._out.append((port, frame))

    def broadcast(self, message: Message, *, everywhere: bool = False) -> None:
        """Send on every port on which something has been heard, or on all."""
        for port in self.ports:
            if everywhere or port.active:
                self.send(port.index, message)

    def send_now(self, port: int, message_id: int) -> None:
        """Send one message of the stream table."""
        self.send(port, streams.BUILDERS[message_id](self))

    def text(self, severity: int, text: str, port: int | None = None) -> None:
        """STATUSTEXT to one port or to all that have been heard."""
        message = mavlink.MAVLink_statustext_message(severity, text.encode()[:TEXT_LENGTH])
        if port is None:
            self.broadcast(message)
        else:
            self.send(port, message)

    # --- parameters, mission, mode ---

    def tell_parameter(self, name: str, count: int | None = None) -> None:
        """PARAM_VALUE to every active port."""
        self.broadcast(self.parameter_protocol.message(name, count=count))

    def parameter_changed(self, name: str) -> None:
        """A station wrote a parameter: speeds act at once."""
        if name.startswith(("WPNAV_", "ANGLE_MAX", "ATC_INPUT_TC")):
            self.forget_limits()
            if self.mode.number == Mode.AUTO:
                self.auto.refresh_limits()

    def mission_changed(self) -> None:
        """An item was stored or the mission shortened."""
        count = float(self.store.count(0))
        if self.params["MIS_TOTAL"] != count:
            self.params.store("MIS_TOTAL", count)
            self.tell_parameter("MIS_TOTAL")
        if self.mode.number == Mode.AUTO:
            self.auto.mission_edited()

    @property
    def mission_busy(self) -> bool:
        """Whether the mission is being flown and may not be cleared."""
        return self.mode.number == Mode.AUTO and self.arming.armed

    def set_mission_current(self, seq: int) -> bool:
        """Make an item the current one; false if there is no such item."""
        return self.auto.runner.set_current(seq)

    def set_mode(self, number: int) -> bool:
        """Change the flight mode; says why where it cannot."""
        if number == self.mode.number:
            return True
        mode = self.modes.get(number)
        if mode is None:
            self.text(WARNING, f"No such mode {number}")
            return False
        if not mode.enter():
            self.text(WARNING, f"Mode change to {MODE_NAMES[number]} failed: init failed")
            return False
        self.mode.leave()
        self.mode = mode
        self.broadcast(telemetry.heartbeat(self), everywhere=True)
        return True

    def disarmed(self) -> None:
        """The motors have stopped."""
        self.land_complete = self.body.landed = True
        self.auto.may_lift = False
        self.auto.runner.reset()
        self.failsafes.disarmed()

    # --- faults ---

    def reboot(self) -> None:
        """Restart: parameters, missions and the signing key stay, all else is forgotten."""
        self.utc_offset_us += round((self.time_s + _DARK_AFTER_REBOOT_S) * 1e6)
        self.runtime_base_s = int(self.params["STAT_RUNTIME"])
        self._power_up()
        self._dark_s = _DARK_AFTER_REBOOT_S

    def kill(self) -> None:
        """Power off for good: it says and does nothing any more."""
        self.dead = True
