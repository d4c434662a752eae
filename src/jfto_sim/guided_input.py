"""SET_POSITION_TARGET_* messages in GUIDED: which fields count, in which frame."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jfto_sim.dialect import Message
from jfto_sim.modes.numbers import Mode

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

Vector = tuple[float, float, float]
_POSITION, _VELOCITY, _ACCEL, _FORCE, _YAW, _YAW_RATE = 0x7, 0x38, 0x1C0, 0x200, 0x400, 0x800
_LOCAL, _LOCAL_OFFSET, _BODY, _BODY_OFFSET = 1, 7, 8, 9
_WPNAV_FOR_POSITIONS = 64
_ABSURD = 1e7  # metres, metres per second: beyond what a position can hold


def _given(mask: int, bits: int) -> bool:
    """A part counts only if none of its bits says ignore."""
    return not mask & bits


def local_ned(v: Vehicle, m: Message) -> None:
    """SET_POSITION_TARGET_LOCAL_NED: metres north, east, down of the EKF origin or of the body."""
    if v.mode.number != Mode.GUIDED or not v.arming.armed:
        return
    if m.coordinate_frame not in (_LOCAL, _LOCAL_OFFSET, _BODY, _BODY_OFFSET):
        return
    if m.type_mask & _FORCE:
        return
    turned = m.coordinate_frame in (_BODY, _BODY_OFFSET)
    position = _enu(v, (m.x, m.y, m.z), turned=turned)
    if m.coordinate_frame != _LOCAL:
        x, y, z = v.body.position_m
        position = (position[0] + x, position[1] + y, position[2] + z)
    velocity = _enu(v, (m.vx, m.vy, m.vz), turned=turned)
    accel = _enu(v, (m.afx, m.afy, m.afz), turned=turned)
    _apply(v, m, position, velocity, accel)


def global_int(v: Vehicle, m: Message) -> None:
    """SET_POSITION_TARGET_GLOBAL_INT; acceleration is ignored when a position is given."""
    if v.mode.number != Mode.GUIDED or not v.arming.armed or m.type_mask & _FORCE:
        return
    height = v.height_of(m.alt, m.coordinate_frame)
    if height is None:
        return
    east, north, _ = v.local_m(m.lat_int, m.lon_int)
    velocity = _enu(v, (m.vx, m.vy, m.vz), turned=False)
    accel = _enu(v, (m.afx, m.afy, m.afz), turned=False)
    if _given(m.type_mask, _POSITION):
        accel = (0.0, 0.0, 0.0)
    _apply(v, m, (east, north, height), velocity, accel)


def _enu(v: Vehicle, ned: Vector, *, turned: bool) -> Vector:
    north, east, down = ned
    if turned:
        yaw = math.radians(v.body.yaw_deg)
        forward, right = north, east
        north = forward * math.cos(yaw) - right * math.sin(yaw)
        east = forward * math.sin(yaw) + right * math.cos(yaw)
    return east, north, -down


def _apply(v: Vehicle, m: Message, position: Vector, velocity: Vector, accel: Vector) -> None:
    parts = (
        position if _given(m.type_mask, _POSITION) else None,
        velocity if _given(m.type_mask, _VELOCITY) else None,
        accel if _given(m.type_mask, _ACCEL) else None,
    )
    if all(part is None for part in parts):
        return
    if any(part is not None and not all(abs(x) < _ABSURD for x in part) for part in parts):
        return
    options = int(v.params["GUID_OPTIONS"])
    if options & _WPNAV_FOR_POSITIONS and parts[1] is None and parts[2] is None:
        v.guided.fly_to(parts[0])
    else:
        v.guided.aim(*parts)
    yaw = math.degrees(m.yaw) if _given(m.type_mask, _YAW) and math.isfinite(m.yaw) else None
    rate = None
    if _given(m.type_mask, _YAW_RATE) and math.isfinite(m.yaw_rate):
        rate = math.degrees(m.yaw_rate)
    v.guided.aim_yaw(yaw, rate)
