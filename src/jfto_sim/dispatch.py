"""Which part of the vehicle answers which message, and which messages are for it at all."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_sim import guided_input, streams
from jfto_sim.dialect import WARNING, Message, mavlink

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

_MISSION = frozenset(
    {
        "MISSION_COUNT", "MISSION_ITEM", "MISSION_ITEM_INT", "MISSION_REQUEST",
        "MISSION_REQUEST_INT", "MISSION_REQUEST_LIST", "MISSION_CLEAR_ALL", "MISSION_SET_CURRENT",
        "MISSION_WRITE_PARTIAL_LIST", "MISSION_ACK",
    }
)  # fmt: skip
_KEY_BYTES = 32


def take(v: Vehicle, m: Message, port: int) -> None:
    """Act on one valid message heard on a port."""
    if m.get_srcSystem() == v.sysid:
        return
    if v.params["SYSID_ENFORCE"] and m.get_srcSystem() != v.params["SYSID_MYGCS"]:
        return
    if getattr(m, "target_system", 0) not in (0, v.sysid):
        return
    kind = m.get_type()
    if kind in _MISSION:
        v.mission_protocol.handle(m, port)
    elif kind in ("COMMAND_LONG", "COMMAND_INT"):
        v.commands.handle(m, port)
    else:
        handler = _HANDLERS.get(kind)
        if handler is not None:
            handler(v, m, port)


def _heartbeat(v: Vehicle, m: Message, _port: int) -> None:
    if m.get_srcSystem() == v.params["SYSID_MYGCS"]:
        v.failsafes.station_heard()


def _timesync(v: Vehicle, m: Message, port: int) -> None:
    """A request (tc1 = 0) is answered with the vehicle's clock; an answer is only noted."""
    if m.tc1 == 0:
        v.send(port, mavlink.MAVLink_timesync_message(v.time_us * 1000, m.ts1))


def _setup_signing(v: Vehicle, m: Message, port: int) -> None:
    if v.arming.armed:
        v.text(WARNING, "ERROR: Won't setup signing when armed", port)
        return
    v.key.install(bytes(m.secret_key[:_KEY_BYTES]), m.initial_timestamp)


_HANDLERS = {
    "HEARTBEAT": _heartbeat,
    "TIMESYNC": _timesync,
    "SETUP_SIGNING": _setup_signing,
    "SET_MODE": lambda v, m, port: v.commands.set_mode_message(m, port),
    "PARAM_REQUEST_READ": lambda v, m, port: v.parameter_protocol.request_read(m, port),
    "PARAM_REQUEST_LIST": lambda v, _, port: v.parameter_protocol.request_list(port),
    "PARAM_SET": lambda v, m, port: v.parameter_protocol.set(m, port),
    "REQUEST_DATA_STREAM": streams.request_stream,
    "SET_POSITION_TARGET_LOCAL_NED": lambda v, m, _: guided_input.local_ned(v, m),
    "SET_POSITION_TARGET_GLOBAL_INT": lambda v, m, _: guided_input.global_int(v, m),
}
