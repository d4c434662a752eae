"""A plain ground station on a socket of a vehicle that runs by itself, simulated or real."""

from __future__ import annotations

import select
import socket
import time
from collections.abc import Callable, Iterable

from jfto_sim.dialect import Message, mavlink
from support.pilot import READY_S, SLICE_S, Heard, Pilot, PilotError

_PATIENCE_S = 120.0
_CHUNK = 65536
_POSITION_KNOWN = mavlink.EKF_POS_HORIZ_ABS


class LivePilot(Pilot):
    """The same on a TCP port of a vehicle that runs by itself, on its own clock.

    Raises PilotError where the vehicle falls silent for `_PATIENCE_S` seconds of the wall.
    """

    def __init__(
        self,
        address: tuple[str, int],
        *,
        real: bool,
        sysid: int = 1,
        system: int = 255,
        component: int = 190,
    ) -> None:
        self.real = real
        self._sysid, self._now_s = sysid, 0.0
        self._socket = socket.create_connection(address, _PATIENCE_S)
        self._listen(system, component)
        wall_s = time.monotonic() + _PATIENCE_S
        while not self._now_s and time.monotonic() < wall_s:
            # asked again: what comes before the vehicle has powered up is lost
            number = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
            wanted = (mavlink.MAVLINK_MSG_ID_SYSTEM_TIME, SLICE_S * 1e6, 0.0, 0.0, 0.0, 0.0, 0.0)
            self.send(mavlink.MAVLink_command_long_message(sysid, 1, number, 0, *wanted))
            self._go_on(SLICE_S)

    @property
    def sysid(self) -> int:
        """The vehicle's system id."""
        return self._sysid

    @property
    def now_s(self) -> float:
        """The vehicle's time as it last said."""
        return self._now_s

    def _put(self, frame: bytes) -> None:
        self._socket.sendall(frame)

    def _pass(self, step_s: float) -> Iterable[bytes]:
        del step_s
        ready, _, _ = select.select([self._socket], [], [], _PATIENCE_S)
        data = self._socket.recv(_CHUNK) if ready else b""
        if not data:
            raise PilotError("The vehicle has fallen silent.")
        return [data]

    def _take(self, message: Message) -> None:
        if message.get_type() == "SYSTEM_TIME":
            self._now_s = message.time_boot_ms / 1000.0
        super()._take(message)

    def wait(self, what: Callable[[Message], bool], limit_s: float = 5.0) -> Heard:
        """Run until a message that fits is heard; raises PilotError if none comes in time."""
        end_s, wall_s = self.now_s + limit_s, time.monotonic() + _PATIENCE_S
        while self.now_s < end_s and time.monotonic() < wall_s:
            first = len(self.heard)
            self._go_on(SLICE_S)
            for heard in self.heard[first:]:
                if what(heard.message):
                    return heard
        raise PilotError(f"Nothing fitting was heard from the vehicle within {limit_s:g} s.")

    def ready(self) -> None:
        """Wait until the vehicle knows where it is; then its own checks may pass."""
        self.every(mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT, 0.5)
        self.wait(
            lambda m: m.get_type() == "EKF_STATUS_REPORT" and m.flags & _POSITION_KNOWN, READY_S * 2
        )
        self.run(2.0)

    def close(self) -> None:
        """Give the socket back."""
        self._socket.close()
