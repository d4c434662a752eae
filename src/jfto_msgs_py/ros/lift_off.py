"""The fleet's word that the flight of a plan began, as std_msgs/Header: when, and of which plan."""

from __future__ import annotations

from typing import Any

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.ros.stamps import decode_time, encode_time


def encode_lift_off(start_ns: int, plan_tag: str) -> Any:
    """std_msgs/Header: the plan's time zero, ns since the epoch, and `plan_tag` of that plan."""
    from std_msgs.msg import Header

    return Header(stamp=encode_time(start_ns), frame_id=plan_tag)


def decode_lift_off(message: Any) -> tuple[int, str]:
    """Time zero and the plan's tag; raises MessageError for a stamp that is no time.

    Older recordings hold a builtin_interfaces/Time, which names no plan: "".
    """
    stamp = getattr(message, "stamp", message)
    return decode_time(stamp, "lift_off"), getattr(message, "frame_id", "")


def lift_off_of(message: Any, plan_tag: str) -> int:
    """Time zero of the plan with that tag; raises MessageError for the lift-off of another one."""
    start_ns, told = decode_lift_off(message)
    if told != plan_tag:
        raise MessageError(
            "lift_off",
            f"is of another plan ({told or 'not named'}, flown here is {plan_tag}): another graph "
            "is on this ROS domain. Set ROS_DOMAIN_ID to another number for one of them",
        )
    return start_ns
