"""COMMAND_LONG and COMMAND_INT: what each does and how it is acknowledged."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from jfto_sim.arming import FORCE
from jfto_sim.command import Command, from_message
from jfto_sim.dialect import ACCEPTED, DENIED, FAILED, INFO, UNSUPPORTED, Message, mavlink
from jfto_sim.mission.items import LOCATION_ALT_MAX_M
from jfto_sim.modes.numbers import Mode
from jfto_sim.streams import KNOWN, SENDABLE

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

_FASTEST_US = 3000
_SET_MODE_COMMAND = 11
_CUSTOM_MODE = 1
_SPEED_MAX_MPS = 1000.0


class Commands:
    """Table of handlers; every command is acknowledged to the port it came from."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.table: dict[int, Callable[[Command], int]] = {
            20: lambda _: self._mode(Mode.RTL),
            21: lambda _: self._mode(Mode.LAND),
            22: self._takeoff,
            17: lambda _: self._mode(Mode.LOITER),
            115: self._condition_yaw,
            176: self._do_set_mode,
            178: self._change_speed,
            179: self._set_home,
            192: self._reposition,
            193: self._pause_continue,
            195: self._look_at,
            201: self._look_at,
            197: self._look_nowhere,
            203: self._shoot,
            206: self._camera_distance,
            205: self._mount,
            224: self._set_mission_current,
            246: self._reboot,
            300: self._mission_start,
            400: self._arm,
            401: self._run_checks,
            410: self._home_position,
            510: self._get_interval,
            511: self._set_interval,
            512: self._request_message,
            520: self._capabilities,
            2000: self._shoot,
        }
        self._after: list[Callable[[], None]] = []

    def handle(self, m: Message, port: int) -> None:
        """Execute and acknowledge; what must follow the acknowledgement follows it."""
        self._after = []
        command = from_message(m, port)
        handler = self.table.get(command.number)
        self.vehicle.hold_back()
        result = UNSUPPORTED if handler is None else handler(command)
        self.acknowledge(m, port, command.number, result)
        self.vehicle.release()
        for action in self._after:
            action()

    def acknowledge(self, m: Message, port: int, number: int, result: int) -> None:
        """COMMAND_ACK to the sender."""
        self.vehicle.send(
            port,
            mavlink.MAVLink_command_ack_message(
                number, result, 0, 0, m.get_srcSystem(), m.get_srcComponent()
            ),
        )

    def set_mode_message(self, m: Message, port: int) -> None:
        """The SET_MODE message is answered like command 11."""
        self.vehicle.hold_back()
        self.acknowledge(m, port, _SET_MODE_COMMAND, self._mode(m.custom_mode, m.base_mode))
        self.vehicle.release()

    # --- modes and flight ---

    def _mode(self, number: float, base: int = _CUSTOM_MODE) -> int:
        if not int(base) & _CUSTOM_MODE:
            return DENIED
        return ACCEPTED if self.vehicle.set_mode(int(number)) else FAILED

    def _do_set_mode(self, c: Command) -> int:
        return self._mode(c.whole(1), c.whole(0))

    def _takeoff(self, c: Command) -> int:
        v = self.vehicle
        ready = v.arming.armed and v.body.landed and v.mode.number == Mode.GUIDED
        if not ready or not 0 < c.z < LOCATION_ALT_MAX_M:
            return FAILED
        v.guided.begin_takeoff(v.home_m[2] + c.z)
        return ACCEPTED

    def _mission_start(self, _c: Command) -> int:
        v = self.vehicle
        if not v.set_mode(Mode.AUTO):
            return FAILED
        self._after.append(v.auto.mission_start)
        return ACCEPTED

    def _arm(self, c: Command) -> int:
        arming, force = self.vehicle.arming, c.p[1] == FORCE
        if c.p[0] == 1:
            return arming.arm(force=force)
        if c.p[0] == 0:
            return arming.disarm(force=force)
        return UNSUPPORTED

    def _run_checks(self, _c: Command) -> int:
        arming = self.vehicle.arming
        if arming.armed:
            return FAILED
        faults = arming.faults()
        self._after.append(lambda: arming.show("PreArm", faults))
        return ACCEPTED

    def _pause_continue(self, c: Command) -> int:
        v = self.vehicle
        if c.p[0] not in (0.0, 1.0):
            return DENIED
        if v.mode.number != Mode.AUTO:
            return FAILED
        v.auto.set_paused(paused=c.p[0] == 0.0)
        return ACCEPTED

    def _change_speed(self, c: Command) -> int:
        if not 0 < c.p[1] < _SPEED_MAX_MPS:
            return FAILED
        v = self.vehicle
        if v.mode.number == Mode.AUTO:
            v.auto.change_speed(c.p[1], c.whole(0))
        else:
            v.speed_override_mps = c.p[1]
        return ACCEPTED

    def _condition_yaw(self, c: Command) -> int:
        if not all(math.isfinite(p) for p in c.p) or not 0 <= c.p[0] <= 360:
            return FAILED
        self.vehicle.heading.turn_to(c.p[0], c.p[1], int(c.p[2]), relative=bool(c.p[3]))
        return ACCEPTED

    def _reposition(self, c: Command) -> int:
        v = self.vehicle
        if v.mode.number != Mode.GUIDED:
            if not c.whole(1) & 1:
                return DENIED
            if not v.set_mode(Mode.GUIDED):
                return FAILED
        height = v.height_of(c.z, c.frame)
        if height is None or not (c.x or c.y):
            return DENIED
        east, north, _ = v.local_m(c.x, c.y)
        v.guided.aim((east, north, height), None, None)
        return ACCEPTED

    # --- mission, home, camera ---

    def _set_mission_current(self, c: Command) -> int:
        v = self.vehicle
        seq = c.p[0]
        if not (math.isfinite(seq) and seq >= 0) or not v.set_mission_current(int(seq)):
            return DENIED
        self._after.append(lambda: v.send_now(c.port, mavlink.MAVLINK_MSG_ID_MISSION_CURRENT))
        return ACCEPTED

    def _set_home(self, c: Command) -> int:
        v = self.vehicle
        if c.p[0] == 1:
            v.move_home()
        elif c.x or c.y:
            if not abs(c.z) < LOCATION_ALT_MAX_M:
                return FAILED
            v.set_home(c.x, c.y, c.z)
        else:
            return FAILED
        return ACCEPTED

    def _home_position(self, c: Command) -> int:
        v = self.vehicle
        if not v.estimator.has_origin(v.time_s):
            return FAILED
        self._after.append(lambda: v.send_now(c.port, mavlink.MAVLINK_MSG_ID_HOME_POSITION))
        return ACCEPTED

    def _look_at(self, c: Command) -> int:
        east, north, _ = self.vehicle.local_m(c.x, c.y)
        self.vehicle.auto.do.watching = True
        self.vehicle.heading.look_at(east, north)
        return ACCEPTED

    def _look_nowhere(self, _c: Command) -> int:
        self.vehicle.auto.do.watching = False
        self.vehicle.heading.follow_track()
        return ACCEPTED

    def _shoot(self, _c: Command) -> int:
        if not self.vehicle.camera.present:
            return UNSUPPORTED
        self._after.append(self.vehicle.camera.shoot)
        return ACCEPTED

    def _camera_distance(self, c: Command) -> int:
        if not self.vehicle.camera.present:
            return UNSUPPORTED
        self.vehicle.camera.every(c.p[0], at_once=c.p[2] == 1)
        return ACCEPTED

    def _mount(self, c: Command) -> int:
        if not self.vehicle.params["MNT1_TYPE"]:
            return FAILED
        self.vehicle.camera.mount_pitch_deg = c.p[0]
        return ACCEPTED

    # --- messages, identity, power ---

    def _get_interval(self, c: Command) -> int:
        message_id = c.whole(0)
        port = self.vehicle.ports[c.port]
        if message_id not in KNOWN:
            found, result = 0, FAILED
        else:
            interval = port.intervals.get(message_id)
            found = -1 if interval is None else round(interval.period_s * 1e6)
            result = ACCEPTED
        answer = mavlink.MAVLink_message_interval_message(message_id & 0xFFFF, found)
        self.vehicle.send(c.port, answer)
        return result

    def _set_interval(self, c: Command) -> int:
        v = self.vehicle
        if not (math.isfinite(c.p[0]) and math.isfinite(c.p[1])):
            return DENIED
        message_id, wanted_us = c.whole(0), c.p[1]
        if message_id not in KNOWN:
            v.text(INFO, f"No ap_message for mavlink id ({message_id})", c.port)
            return DENIED
        if wanted_us <= 0:
            period_s = 0.0
            if wanted_us == 0 and message_id == mavlink.MAVLINK_MSG_ID_HEARTBEAT:
                period_s = 1.0
        else:
            period_s = max(wanted_us, _FASTEST_US) * 1e-6
        v.ports[c.port].set_interval(message_id, period_s, v.time_s)
        return ACCEPTED

    def _request_message(self, c: Command) -> int:
        message_id = c.whole(0)
        if message_id not in SENDABLE:
            return FAILED
        self._after.append(lambda: self.vehicle.send_now(c.port, message_id))
        return ACCEPTED

    def _capabilities(self, c: Command) -> int:
        if c.p[0] != 1:
            return FAILED
        message_id = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
        self._after.append(lambda: self.vehicle.send_now(c.port, message_id))
        return ACCEPTED

    def _reboot(self, c: Command) -> int:
        v = self.vehicle
        if v.arming.armed:
            return FAILED
        if c.p[0] not in (1.0, 3.0):
            return UNSUPPORTED
        self._after.append(v.reboot)
        return ACCEPTED
