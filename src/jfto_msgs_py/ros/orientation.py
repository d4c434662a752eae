"""Compass heading as a quaternion in ENU, and back (REP 103)."""

from __future__ import annotations

import math
from typing import Any

from jfto_msgs_py.errors import MessageError


def encode_heading(yaw_deg: float) -> Any:
    """geometry_msgs/Quaternion of a heading clockwise from north; body x points forward."""
    from geometry_msgs.msg import Quaternion

    half = math.radians(90.0 - yaw_deg) / 2
    return Quaternion(x=0.0, y=0.0, z=math.sin(half), w=math.cos(half))


def decode_heading(quaternion: Any, field: str = "pose.orientation") -> float:
    """Heading in degrees clockwise from north, in [0, 360). Raises MessageError for a null one."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    norm = x * x + y * y + z * z + w * w
    if not (math.isfinite(norm) and abs(norm - 1.0) < 1e-3):
        raise MessageError(field, f"has norm² {norm}, expected 1")
    yaw_enu = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return (90.0 - math.degrees(yaw_enu)) % 360.0
