"""The MAVLink 2 dialect that the simulator speaks, and the few constants it uses by name."""

from __future__ import annotations

from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

__all__ = [
    "ACCEPTED",
    "CRITICAL",
    "DEBUG",
    "DENIED",
    "EMERGENCY",
    "FAILED",
    "INFO",
    "NOTICE",
    "TEXT_LENGTH",
    "UNSUPPORTED",
    "WARNING",
    "Message",
    "mavlink",
]

Message = Any  # pymavlink's messages carry their fields as attributes and have no common types

ACCEPTED: int = mavlink.MAV_RESULT_ACCEPTED
DENIED: int = mavlink.MAV_RESULT_DENIED
UNSUPPORTED: int = mavlink.MAV_RESULT_UNSUPPORTED
FAILED: int = mavlink.MAV_RESULT_FAILED

EMERGENCY, CRITICAL, WARNING, NOTICE, INFO, DEBUG = 0, 2, 4, 5, 6, 7

TEXT_LENGTH = 50
