"""One ArduCopter-like vehicle as a pure state machine: no sockets, no wall clock, seeded.

`handle` takes bytes received on a port, `advance` moves the vehicle's clock and returns the frames
sent meanwhile. What came in is looked at every 5 ms, as the autopilot's own loop does; the body
moves in steps of 20 ms.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Protocol

from jfto_msgs_py.errors import InputError
from jfto_sim.arming import Arming
from jfto_sim.battery import Battery
from jfto_sim.boot import Boot
from jfto_sim.camera import Camera
from jfto_sim.clock import Clock
from jfto_sim.commands import Command, Commands
from jfto_sim.config import VehicleConfig
from jfto_sim.dialect import ACCEPTED, FAILED, UNSUPPORTED, WARNING, Message, mavlink
from jfto_sim.estimator import Estimator
from jfto_sim.failsafe import Failsafes
from jfto_sim.flight import Flight, LandDetector, Motors
from jfto_sim.flight_loop import FlightLoop
from jfto_sim.mission.fence import Fence
from jfto_sim.mission.items import Store
from jfto_sim.mission.protocol import MissionProtocol
from jfto_sim.modes.auto import Auto
from jfto_sim.modes.flight_commands import FlightCommands
from jfto_sim.modes.guided import Guided
from jfto_sim.modes.mode import FlightMode, Mode, Modes
from jfto_sim.modes.rtl import Rtl
from jfto_sim.modes.simple import Brake, Land, Loiter, Manual
from jfto_sim.motion.body import Body
from jfto_sim.motion.heading import Heading
from jfto_sim.motion.limits import Limits
from jfto_sim.parameters import ParameterProtocol, Parameters
from jfto_sim.ports import Frame, MessageHandler, Port, Ports
from jfto_sim.position import Position
from jfto_sim.signing import SigningKey
from jfto_sim.streams import Streams
from jfto_sim.telemetry import Telemetry

LOOP_S = 0.005
STEP_S = 0.02
_WATCH_S = 0.1
_TIMESYNC_FIRST_S, _TIMESYNC_EVERY_S = 10.0018, 10.00266
_DARK_AFTER_REBOOT_S = 0.3
_INBOX_MAX = 20_000
_KEY_BYTES = 32
_LIMITS_OF = ("WPNAV_", "ANGLE_MAX", "ATC_INPUT_TC")


class Timed(Protocol):
    """A part that acts at times of its own."""

    @property
    def next_s(self) -> float:
        """When, in seconds since power-up."""

    def tick(self) -> None:
        """Do what is due by now."""


class Vehicle:
    """Storage that outlives a restart, and the parts that each power-up makes anew."""

    def __init__(self, config: VehicleConfig | None = None) -> None:
        self.config = config or VehicleConfig()
        overrides = {"SYSID_THISMAV": float(self.config.sysid), **self.config.parameters}
        self.params = Parameters(overrides)
        self.store = Store()
        self.key = SigningKey()
        self.clock = Clock(self.config.utc_at_boot_us, self.config.clock_drift_ppm)
        self.body = Body(self.config.airframe, self.config.heading_deg, self.config.ground)
        self.boots = 0
        self.dead = False
        self._out: list[Frame] = []
        self._power_up()

    # --- composition ---

    def _power_up(self) -> None:
        """Everything that a restart forgets."""
        self.boots += 1
        self.sysid = int(self.params["SYSID_THISMAV"])
        self._dark_s = 0.0
        self._restart_asked = False
        self._inbox: deque[tuple[int, bytes]] = deque(maxlen=_INBOX_MAX)
        self._next_step_s, self._next_watch_s = STEP_S, _WATCH_S
        self._next_timesync_s = _TIMESYNC_FIRST_S
        ports = [
            Port(k, self.sysid, self.key, mavlink1=self.params[f"SERIAL{k}_PROTOCOL"] == 1)
            for k in range(self.config.port_count)
        ]
        self.ports = Ports(ports, self.key, self.clock, self._out)
        self.parameters = ParameterProtocol(
            self.params, self.clock, self.ports, self._parameter_changed
        )
        self.battery = Battery(self.params)
        self.estimator = Estimator(self.params, self.clock)
        self.flight = self._make_flight()
        self.fence = Fence(self.params, self.store, self.flight.position)
        self._make_modes()
        self._make_conversations()

    def _make_flight(self) -> Flight:
        """On the ground where the vehicle stands, heading as it was set down."""
        before = self.body
        self.body = Body(self.config.airframe, before.yaw_deg, self.config.ground)
        self.body.state[:3] = before.state[:3]
        return Flight(
            clock=self.clock,
            params=self.params,
            ports=self.ports,
            body=self.body,
            heading=Heading(before.yaw_deg),
            limits=Limits(self.params, self.body),
            position=Position(self.config, self.clock, self.estimator, self.body, self.ports),
            motors=Motors(self.clock, self.config.hesitation_s),
            land=LandDetector(),
        )

    def _make_modes(self) -> None:
        """Flight modes, what steps them and what changes them."""
        flight, battery, estimator = self.flight, self.battery, self.estimator
        self.camera = Camera(flight)
        self.auto = Auto(flight, self.store, self.fence, self.camera, self._terrain_missing)
        self.guided, land = Guided(flight, self.fence), Land(flight)
        manual = (Manual(flight, Mode.STABILIZE), Manual(flight, Mode.ALT_HOLD))
        rtl = Rtl(flight, self.fence)
        modes = (*manual, self.auto, self.guided, rtl, Loiter(flight), land, Brake(flight))
        self.modes = Modes(modes, flight, estimator, self._announce_mode)
        self.loop = FlightLoop(flight, battery, self.modes, self.config.wind_mps)
        self.failsafes = Failsafes(flight, battery, estimator, self.fence, self.modes, land)
        self.arming = Arming(
            flight, battery, estimator, self.store, self.fence, self.modes,
            lambda: self.failsafes.station_lost, self.parameters.announce,
        )  # fmt: skip

    def _make_conversations(self) -> None:
        """What is sent unasked, and who answers which message."""
        flight, clock, ports = self.flight, self.clock, self.ports
        self.telemetry = Telemetry(
            self.config, flight, self.loop, self.estimator, self.battery, self.modes, self.auto,
            self.arming, self.failsafes,
        )  # fmt: skip
        self._streams = Streams(ports, clock, self.telemetry)
        self.mission_protocol = MissionProtocol(
            clock, ports, self.store, self.parameters, flight.position, self.auto
        )
        flying = FlightCommands(flight, self.modes, self.auto, self.guided)
        boot = Boot(
            clock, ports, self.parameters, flight.position, self.boots, self.config.home_alt_m,
            self.loop,
        )  # fmt: skip
        commands = Commands(
            ports,
            self.arming.commands,
            self.camera.commands,
            flight.position.commands,
            self._streams.commands,
            flying.commands,
            {
                mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: self._do_reboot,
                mavlink.MAV_CMD_DO_FENCE_ENABLE: self._do_fence,
            },
        )
        self._timed: tuple[Timed, ...] = (boot, self.arming, self.parameters, self.mission_protocol)
        self._handlers: dict[str, MessageHandler] = {
            **commands.messages,
            **self.parameters.messages,
            **self.mission_protocol.messages,
            **self._streams.messages,
            **self.failsafes.messages,
            **self.guided.messages,
            **flying.messages,
            "TIMESYNC": self._timesync,
            "SETUP_SIGNING": self._setup_signing,
        }

    # --- in and out ---

    @property
    def time_s(self) -> float:
        """Seconds since power-up."""
        return self.clock.time_s

    @property
    def total_s(self) -> float:
        """Seconds since the vehicle was made, restarts included."""
        return self.clock.total_s

    @property
    def utc_us(self) -> int:
        """UTC of the vehicle's own clock in microseconds."""
        return self.clock.utc_us

    @property
    def mode(self) -> FlightMode:
        """The flight mode in force."""
        return self.modes.current

    def handle(self, data: bytes, port: int = 0) -> None:
        """Bytes received on a port; answers come out of `advance` up to 5 ms later."""
        if not self.dead and self._dark_s <= 0.0:
            self._inbox.append((port, bytes(data)))

    def advance(self, dt_s: float) -> list[Frame]:
        """Let `dt_s` seconds pass; returns the (port, frame) pairs sent meanwhile, in order."""
        clock = self.clock
        clock.total_s += dt_s
        own_s = dt_s * (1.0 + clock.drift_ppm * 1e-6)
        if self.dead:
            return []
        if self._dark_s > 0.0:
            self._dark_s -= own_s
            if self._dark_s > 0.0:
                return []
            own_s, self._dark_s = -self._dark_s, 0.0
        end = clock.time_s + own_s
        while clock.time_s < end and self._dark_s <= 0.0:
            clock.time_s = min(end, self._next_event_s())
            self._run_due()
        frames = list(self._out)
        self._out.clear()
        return frames

    def _next_event_s(self) -> float:
        now = self.clock.time_s
        times = [part.next_s for part in (*self._timed, self._streams)]
        times += [self._next_step_s, self._next_timesync_s]
        if self._inbox:
            times.append((math.floor(now / LOOP_S + 1e-6) + 1) * LOOP_S)
        return max(min(times), now)

    def _run_due(self) -> None:
        now = self.clock.time_s + 1e-9
        if self._inbox and abs(now / LOOP_S - round(now / LOOP_S)) < 1e-4:
            self._read_inbox()
            if self._dark_s > 0.0:
                return
        for part in self._timed:
            part.tick()
        if now >= self._next_step_s:
            self._next_step_s += STEP_S
            self.loop.step(STEP_S)
        if now >= self._next_watch_s:
            self._next_watch_s += _WATCH_S
            self.failsafes.tick()
        if now >= self._next_timesync_s:
            self._next_timesync_s += _TIMESYNC_EVERY_S
            stamp_ns = self.clock.time_us * 1000 + self.config.sysid
            self.ports.broadcast(mavlink.MAVLink_timesync_message(0, stamp_ns), everywhere=True)
        self._streams.tick()

    def _read_inbox(self) -> None:
        while self._inbox:
            index, data = self._inbox.popleft()
            for message in self.ports[index].decode(data):
                if self._is_for_this(message):
                    handler = self._handlers.get(message.get_type())
                    if handler is not None:
                        handler(message, index)
                if self._restart_asked:
                    self.reboot()
                    return

    def _is_for_this(self, m: Message) -> bool:
        sender = m.get_srcSystem()
        if sender == self.sysid or getattr(m, "target_system", 0) not in (0, self.sysid):
            return False
        return not self.params["SYSID_ENFORCE"] or sender == self.params["SYSID_MYGCS"]

    def _timesync(self, m: Message, port: int) -> None:
        """A request (tc1 = 0) is answered with the vehicle's clock; an answer changes nothing."""
        if m.tc1 == 0:
            answer = mavlink.MAVLink_timesync_message(self.clock.time_us * 1000, m.ts1)
            self.ports.send(port, answer)

    def _setup_signing(self, m: Message, port: int) -> None:
        if self.flight.motors.armed:
            self.ports.text(WARNING, "ERROR: Won't setup signing when armed", port)
            return
        self.key.install(bytes(m.secret_key[:_KEY_BYTES]), m.initial_timestamp)

    def _announce_mode(self) -> None:
        self.fence.mode_changed(self.clock.time_s)
        self.ports.broadcast(self.telemetry.heartbeat(), everywhere=True)

    def _terrain_missing(self) -> None:
        self.failsafes.terrain_missing()

    def set_parameter(self, name: str, value: float) -> None:
        """Set a parameter as another station would; raises InputError for an unknown name."""
        if name not in self.params:
            raise InputError(f"{name} is not a parameter of ArduCopter 4.5.5.")
        self.parameters.store_and_announce(name, value)
        self._parameter_changed(name)

    def _parameter_changed(self, name: str) -> None:
        """A station wrote a parameter: speeds act at once."""
        if name.startswith(_LIMITS_OF):
            self.flight.limits.reread()
            if self.auto.active:
                self.auto.nav_items.refresh_limits()

    def _do_fence(self, c: Command) -> int:
        return ACCEPTED if self.fence.switch(c.p[0]) else FAILED

    # --- power ---

    def _do_reboot(self, c: Command) -> int:
        if self.flight.motors.armed:
            return FAILED
        if c.p[0] not in (1.0, 3.0):
            return UNSUPPORTED
        self._restart_asked = True
        return ACCEPTED

    def reboot(self) -> None:
        """Restart: parameters, missions and the signing key stay, all else is forgotten."""
        self.clock.restart(_DARK_AFTER_REBOOT_S)
        self._power_up()
        self._dark_s = _DARK_AFTER_REBOOT_S

    def kill(self) -> None:
        """Power off for good: it says and does nothing any more."""
        self.dead = True
