"""What upload and download have in common: patience, and what a MISSION_ACK means."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_mavlink.dialect import Message, enum_name, mavlink
from jfto_mavlink.exchange import Context

ACCEPTED = mavlink.MAV_MISSION_ACCEPTED
ERROR = mavlink.MAV_MISSION_ERROR
BUSY = mavlink.MAV_MISSION_DENIED
CANCELLED = mavlink.MAV_MISSION_OPERATION_CANCELLED
OUT_OF_SEQUENCE = mavlink.MAV_MISSION_INVALID_SEQUENCE


@dataclass(frozen=True)
class Patience:
    """Time-outs of a transfer, in seconds of the vehicle's clock.

    ArduCopter asks for a missing item every 1.0 s and gives an upload up 8.0 s after the last good
    item; another station's abandoned upload therefore blocks ours for 8 s.
    """

    silence_s: float = 9.5
    starts: int = 6
    lost_s: float = 30.0
    busy_s: float = 60.0
    busy_retry_s: float = 1.5
    resend_ceiling_s: float = 1.0
    window: int = 4


def ack_type(context: Context, message: Message, mission_type: int) -> int | None:
    """Type of a MISSION_ACK that is meant for us and for this kind of mission, else None."""
    if (
        message.get_type() != "MISSION_ACK"
        or message.mission_type != mission_type
        or not context.addressed(message)
    ):
        return None
    return message.type


def ack_name(code: int) -> str:
    """Name of a MISSION_ACK type without its prefix."""
    return enum_name("MAV_MISSION_RESULT", code).removeprefix("MAV_MISSION_")
