"""Names that other programs give to a waypoint's angles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage.raw_waypoint import number

YAW = ("yaw_deg", "yaw", "heading_deg", "heading", "gimbal_yaw", "gimbalyaw", "bearing", "azimuth")
PITCH = (
    "pitch_deg",
    "pitch",
    "gimbal_pitch_deg",
    "gimbal_pitch",
    "gimbalpitch",
    "gimbalpitchangle",
    "gimbal_angle",
    "gimbalangle",
    "camera_pitch",
)
ANGLES = frozenset((*YAW, *PITCH))


def angles(values: Mapping[str, Any], place: str) -> tuple[float, float]:
    """Yaw (0 to 360) and pitch in degrees from values by name in small letters.

    0 and -90 where none or an empty one is given. Raises WaypointError, also where two names of one
    angle disagree.
    """
    return _angle(values, YAW, 0.0, place) % 360.0, _angle(values, PITCH, -90.0, place)


def not_used(source: str, names: Iterable[str], used: Iterable[str]) -> list[str]:
    """One line that names what waypoints carry and nothing reads; none where that is nothing."""
    rest = sorted({str(name)[:40] for name in names} - {*used})
    return [f"{source}: not used: {', '.join(rest)}"] if rest else []


def _angle(values: Mapping[str, Any], names: tuple[str, ...], default: float, place: str) -> float:
    given = {
        name: number(values[name], name, place)
        for name in names
        if name in values and values[name] not in (None, "")
    }
    if len(set(given.values())) > 1:
        told = " and ".join(f"{name} {value:g}" for name, value in given.items())
        raise WaypointError(f"{place}: has {told} for one angle. Leave one of them.")
    return next(iter(given.values()), default)
