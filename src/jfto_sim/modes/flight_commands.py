"""Commands that change the mode, the goal, the speed or the heading."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_sim.commands import Command, CommandHandler
from jfto_sim.dialect import ACCEPTED, DENIED, FAILED, Message, mavlink
from jfto_sim.flight import Flight
from jfto_sim.geodesy import LOCATION_ALT_MAX_M
from jfto_sim.modes.auto import Auto
from jfto_sim.modes.guided import Guided
from jfto_sim.modes.mode import Mode, Modes
from jfto_sim.ports import MessageHandler

_SET_MODE_COMMAND = 11
_CUSTOM_MODE = 1
_SPEED_MAX_MPS = 1000.0


@dataclass
class FlightCommands:
    """Handlers for the table of commands, and for the SET_MODE message."""

    flight: Flight
    modes: Modes
    auto: Auto
    guided: Guided

    def __post_init__(self) -> None:
        self.commands: dict[int, CommandHandler] = {
            mavlink.MAV_CMD_NAV_LOITER_UNLIM: lambda _: self._set_mode(Mode.LOITER),
            mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda _: self._set_mode(Mode.RTL),
            mavlink.MAV_CMD_NAV_LAND: lambda _: self._set_mode(Mode.LAND),
            mavlink.MAV_CMD_NAV_TAKEOFF: self._takeoff,
            mavlink.MAV_CMD_CONDITION_YAW: self._condition_yaw,
            mavlink.MAV_CMD_DO_SET_MODE: lambda c: self._set_mode(c.whole(1), c.whole(0)),
            mavlink.MAV_CMD_DO_CHANGE_SPEED: self._change_speed,
            mavlink.MAV_CMD_DO_REPOSITION: self._reposition,
            mavlink.MAV_CMD_DO_PAUSE_CONTINUE: self._pause_continue,
            mavlink.MAV_CMD_DO_SET_ROI_LOCATION: self._look_at,
            mavlink.MAV_CMD_DO_SET_ROI_NONE: self._look_nowhere,
            mavlink.MAV_CMD_DO_SET_ROI: self._look_at,
            mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: self._set_mission_current,
            mavlink.MAV_CMD_MISSION_START: self._mission_start,
        }
        self.messages: dict[str, MessageHandler] = {"SET_MODE": self._set_mode_message}

    def _set_mode_message(self, m: Message, port: int) -> None:
        """The SET_MODE message is answered like command 11."""
        self.flight.ports.acknowledge(
            m, port, _SET_MODE_COMMAND, lambda: self._set_mode(m.custom_mode, m.base_mode)
        )

    def _set_mode(self, number: int, base: int = _CUSTOM_MODE) -> int:
        if not base & _CUSTOM_MODE:
            return DENIED
        return ACCEPTED if self.modes.set(number) else FAILED

    def _takeoff(self, c: Command) -> int:
        flight = self.flight
        ready = flight.motors.armed and flight.body.landed and self.guided.active
        if not ready or not 0 < c.z < LOCATION_ALT_MAX_M:
            return FAILED
        self.guided.begin_takeoff(flight.position.home_m[2] + c.z)
        return ACCEPTED

    def _mission_start(self, _c: Command) -> int:
        if not self.modes.set(Mode.AUTO):
            return FAILED
        self.auto.mission_start()
        return ACCEPTED

    def _pause_continue(self, c: Command) -> int:
        if c.p[0] not in (0.0, 1.0):
            return DENIED
        if not self.auto.active:
            return FAILED
        self.auto.nav_items.nav.paused = c.p[0] == 0.0
        return ACCEPTED

    def _change_speed(self, c: Command) -> int:
        if not 0 < c.p[1] < _SPEED_MAX_MPS:
            return FAILED
        if self.auto.active:
            self.auto.nav_items.change_speed(c.p[1], c.whole(0))
        else:
            self.flight.limits.speed_mps = c.p[1]
        return ACCEPTED

    def _condition_yaw(self, c: Command) -> int:
        if not all(math.isfinite(p) for p in c.p) or not 0 <= c.p[0] <= 360:
            return FAILED
        self.flight.heading.turn_to(c.p[0], c.p[1], int(c.p[2]), relative=bool(c.p[3]))
        return ACCEPTED

    def _reposition(self, c: Command) -> int:
        if not self.guided.active:
            if not c.whole(1) & 1:
                return DENIED
            if not self.modes.set(Mode.GUIDED):
                return FAILED
        position = self.flight.position
        height = position.height_of(c.z, c.frame)
        if height is None or not (c.x or c.y):
            return DENIED
        taken = self.guided.aim((*position.local_m(c.x, c.y), height), None, None)
        return ACCEPTED if taken else FAILED

    def _look_at(self, c: Command) -> int:
        self.auto.do_items.look_at(c.x, c.y)
        return ACCEPTED

    def _look_nowhere(self, _c: Command) -> int:
        self.auto.do_items.look_ahead()
        return ACCEPTED

    def _set_mission_current(self, c: Command) -> int:
        seq = c.p[0]
        if not (math.isfinite(seq) and seq >= 0) or not self.auto.set_current(int(seq)):
            return DENIED
        self.auto.send_current(c.port)
        return ACCEPTED
