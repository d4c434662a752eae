"""Names that other programs give to what a waypoint carries."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from jfto_msgs_py.mission_file.document import MissionTextError
from jfto_msgs_py.mission_file.points import number

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
PHOTO = ("take_photo", "photo")


def angles(values: Mapping[str, Any], place: str) -> tuple[float, float]:
    """Yaw (0 to 360) and pitch in degrees from values by name in small letters.

    0 and -90 where none or an empty one is given. Raises MissionTextError, also where two names of
    one angle disagree, and for a yaw outside -360…360 or a pitch outside -90…90.
    """
    yaw_deg = _angle(values, YAW, 0.0, 360.0, place)
    return yaw_deg % 360.0, _angle(values, PITCH, -90.0, 90.0, place)


def switched_off(values: Mapping[str, Any]) -> bool:
    """Whether values by name say that no photo is taken here."""
    told = [str(values[name]).strip().lower() for name in PHOTO if name in values]
    return any(word in ("false", "0", "no") for word in told)


def not_used(source: str, names: Iterable[str], used: Iterable[str]) -> list[str]:
    """One line that names what waypoints carry and nothing reads; none where that is nothing."""
    rest = sorted({str(name)[:40] for name in names} - {*used})
    return [f"{source}: not used: {', '.join(rest)}"] if rest else []


def _angle(
    values: Mapping[str, Any], names: tuple[str, ...], default: float, most: float, place: str
) -> float:
    given = {
        name: number(values[name], name, place)
        for name in names
        if name in values and values[name] not in (None, "")
    }
    if len(set(given.values())) > 1:
        told = " and ".join(f"{name} {value:g}" for name, value in given.items())
        raise MissionTextError(f"{place}: has {told} for one angle. Leave one of them.")
    for name, value in given.items():
        if abs(value) > most:
            raise MissionTextError(
                f"{place}: {name} is {value:g}, outside {-most:g}…{most:g} deg. Correct it; it may "
                "be another column's, or in other units."
            )
    return next(iter(given.values()), default)
