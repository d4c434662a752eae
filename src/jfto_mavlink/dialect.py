"""The MAVLink dialect in use, and ArduCopter's names for its modes.

Every module takes the generated message set from here, so that the wire version (2) never depends
on an environment variable.
"""

from __future__ import annotations

from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

# Generated message classes carry no types.
Message = Any

MODES: dict[str, int] = {
    "STABILIZE": 0,
    "ALT_HOLD": 2,
    "AUTO": 3,
    "GUIDED": 4,
    "LOITER": 5,
    "RTL": 6,
    "LAND": 9,
    "POSHOLD": 16,
    "BRAKE": 17,
    "SMART_RTL": 21,
}
MODE_NAMES = {number: name for name, number in MODES.items()}


def mode_name(number: int | None) -> str:
    """Name of a copter mode number, "mode 77" for one without a name here."""
    if number is None:
        return "unknown"
    return MODE_NAMES.get(number, f"mode {number}")


def enum_name(enum: str, value: int) -> str:
    """Name of a MAVLink enumeration value, for example MAV_MISSION_DENIED."""
    entry = mavlink.enums[enum].get(value)
    return entry.name if entry is not None else f"{enum} {value}"


__all__ = ["MODES", "MODE_NAMES", "Message", "enum_name", "mavlink", "mode_name"]
