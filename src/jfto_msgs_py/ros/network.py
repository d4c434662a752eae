"""Adjacency, power intervals and schedules as multi-arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.network import Adjacency, PowerIntervals, PowerSchedule
from jfto_msgs_py.ros import multi_array


def encode_adjacency(adjacency: Adjacency) -> Any:
    """std_msgs/UInt8MultiArray [slot, uav, uav] with 1 for an active link."""
    from std_msgs.msg import UInt8MultiArray

    uavs = multi_array.uav_label(adjacency.uav_ids)
    names = (multi_array.slot_label(adjacency.horizon), uavs, uavs)
    return multi_array.fill(UInt8MultiArray(), adjacency.links.astype(np.uint8), names)


def decode_adjacency(message: Any) -> Adjacency:
    """Adjacency in a std_msgs/UInt8MultiArray. Raises MessageError naming the field at fault."""
    shape, names = multi_array.shape_and_labels(message, 3)
    horizon = multi_array.parse_slot_label(names[0], shape[0])
    uav_ids = multi_array.parse_uav_label(names[1], shape[1])
    if multi_array.parse_uav_label(names[2], shape[2]) != uav_ids:
        raise MessageError("layout.dim[2].label", "names other UAVs than layout.dim[1].label")
    links = multi_array.values(message, shape, np.uint8)
    if (links > 1).any():
        raise MessageError("adjacency.data", f"holds {links.max()}, expected 0 or 1")
    return Adjacency(horizon, uav_ids, links.astype(np.bool_))


def encode_power_intervals(intervals: PowerIntervals) -> Any:
    """std_msgs/Float64MultiArray [slot, uav, bound] in W."""
    from std_msgs.msg import Float64MultiArray

    names = (
        multi_array.slot_label(intervals.horizon),
        multi_array.uav_label(intervals.uav_ids),
        multi_array.BOUND_LABEL,
    )
    return multi_array.fill(Float64MultiArray(), intervals.bounds_w, names)


def decode_power_intervals(message: Any) -> PowerIntervals:
    """Power intervals in a std_msgs/Float64MultiArray. Raises MessageError naming the field."""
    shape, names = multi_array.shape_and_labels(message, 3)
    if names[2] != multi_array.BOUND_LABEL:
        raise MessageError(
            "layout.dim[2].label", f"is {names[2]!r}, expected {multi_array.BOUND_LABEL!r}"
        )
    horizon = multi_array.parse_slot_label(names[0], shape[0])
    uav_ids = multi_array.parse_uav_label(names[1], shape[1])
    return PowerIntervals(horizon, uav_ids, multi_array.values(message, shape, np.float64))


def encode_power_schedule(schedule: PowerSchedule) -> Any:
    """std_msgs/Float64MultiArray [slot, uav] in W."""
    from std_msgs.msg import Float64MultiArray

    names = (multi_array.slot_label(schedule.horizon), multi_array.uav_label(schedule.uav_ids))
    return multi_array.fill(Float64MultiArray(), schedule.power_w, names)


def decode_power_schedule(message: Any) -> PowerSchedule:
    """Power schedule in a std_msgs/Float64MultiArray. Raises MessageError naming the field."""
    shape, names = multi_array.shape_and_labels(message, 2)
    horizon = multi_array.parse_slot_label(names[0], shape[0])
    uav_ids = multi_array.parse_uav_label(names[1], shape[1])
    return PowerSchedule(horizon, uav_ids, multi_array.values(message, shape, np.float64))
