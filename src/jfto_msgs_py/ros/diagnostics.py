"""What a node says about itself and about each UAV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.ros.stamps import decode_time, encode_time

OK, WARN, ERROR, STALE = range(4)


@dataclass(frozen=True)
class Status:
    """One status: about a UAV, or about the node where `uav_id` is ""; `level` is OK … STALE."""

    uav_id: str
    level: int
    text: str
    facts: Mapping[str, str] = field(default_factory=dict)


def encode_diagnostics(node_name: str, stamp_ns: int, statuses: Sequence[Status]) -> Any:
    """diagnostic_msgs/DiagnosticArray with a status per UAV and one for the node."""
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

    message = DiagnosticArray()
    message.header.stamp = encode_time(stamp_ns)
    message.status = [
        DiagnosticStatus(
            level=bytes([status.level]),
            name=f"{node_name}: {status.uav_id}" if status.uav_id else node_name,
            message=status.text,
            hardware_id=status.uav_id or "fleet",
            values=[KeyValue(key=key, value=value) for key, value in status.facts.items()],
        )
        for status in statuses
    ]
    return message


@dataclass(frozen=True)
class Diagnostics:
    """What a node said at a moment (ns since the epoch on its clock)."""

    node_name: str
    stamp_ns: int
    statuses: tuple[Status, ...]


def decode_diagnostics(message: Any) -> Diagnostics:
    """Statuses of one of our nodes. Raises MessageError for those of other programs."""
    statuses, names = [], set()
    for index, status in enumerate(message.status):
        node_name, _, uav_id = status.name.partition(": ")
        # rclpy has a byte as bytes, readers of bags have it as a number.
        level = status.level
        level = level if isinstance(level, int) else int.from_bytes(level, "little")
        if not node_name or level > STALE:
            raise MessageError(f"status[{index}].name", f"{status.name!r} at level {level}")
        names.add(node_name)
        facts = {value.key: value.value for value in status.values}
        statuses.append(Status(uav_id, level, status.message, facts))
    if len(names) != 1:
        raise MessageError("status", f"speaks for {len(names)} nodes, must for one")
    return Diagnostics(names.pop(), decode_time(message.header.stamp), tuple(statuses))
