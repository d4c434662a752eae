"""A waypoint just read, which still knows where it stood in its file."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.plan import Vector


@dataclass(frozen=True)
class RawWaypoint:
    """`place` names line or item, for messages; yaw and pitch as in `Waypoint`."""

    place: str
    position_m: Vector
    yaw_deg: float = 0.0
    pitch_deg: float = -90.0
