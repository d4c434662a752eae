"""The MAVLink 2 dialect that the simulator speaks, and the few constants it uses by name."""

from __future__ import annotations

from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

Message = Any  # pymavlink's messages carry their fields as attributes and have no common types

ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
DENIED = mavlink.MAV_RESULT_DENIED
UNSUPPORTED = mavlink.MAV_RESULT_UNSUPPORTED
FAILED = mavlink.MAV_RESULT_FAILED

EMERGENCY, CRITICAL, WARNING, NOTICE, INFO, DEBUG = 0, 2, 4, 5, 6, 7

TEXT_LENGTH = 50
