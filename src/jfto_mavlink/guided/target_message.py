"""Targets as SET_POSITION_TARGET_LOCAL_NED: position, velocity, acceleration, yaw, yaw rate."""

from __future__ import annotations

import math

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.exchange import Context
from jfto_mavlink.guided.local_frame import EkfFrame, ned
from jfto_mavlink.guided.reference import Reference

_POSITION, _FORCE = 0x007, 0x200
_YAW, _YAW_RATE = 0x400, 0x800


def target_message(
    context: Context, frame: EkfFrame, target: Reference, heading: tuple[float, float] | None
) -> Message:
    """A target to pass through; `heading` is yaw (deg) and its rate (deg/s), None for any.

    The GLOBAL_INT form of this message drops the acceleration, measured to cost 0.8 m.
    """
    mask = 0 if heading is not None else _YAW | _YAW_RATE
    yaw_deg, rate_dps = heading or (0.0, 0.0)
    return _message(
        context,
        mask,
        (
            *frame.position_ned_m(target.position_m),
            *ned(target.velocity_mps),
            *ned(target.acceleration_mps2),
        ),
        (math.radians((yaw_deg + 180.0) % 360.0 - 180.0), math.radians(rate_dps)),
    )


def stop_message(context: Context) -> Message:
    """Come to rest: velocity and acceleration 0, wherever that is."""
    return _message(context, _POSITION | _YAW | _YAW_RATE, (0.0,) * 9, (0.0, 0.0))


def _message(
    context: Context, mask: int, motion: tuple[float, ...], turn: tuple[float, float]
) -> Message:
    boot_ms = int(context.clock() * 1000) & 0xFFFFFFFF
    return mavlink.MAVLink_set_position_target_local_ned_message(
        boot_ms, *context.target, mavlink.MAV_FRAME_LOCAL_NED, mask & ~_FORCE, *motion, *turn
    )
