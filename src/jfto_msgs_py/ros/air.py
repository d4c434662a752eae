"""What radios report at one moment, as a multi-array each, `uav;ids=uav1,uav2;t=1763776800.25`."""

from __future__ import annotations

from typing import Any

import numpy as np

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.air import AirArray, AirReport
from jfto_msgs_py.ros import multi_array, topics

# Topic of each array of a report.
ARRAY_OF_TOPIC = {
    topics.AIR_POWER: "power_w",
    topics.AIR_ENERGY: "energy_j",
    topics.AIR_RATE: "rate_bps",
    topics.AIR_DELIVERY: "delivery",
    topics.AIR_GAIN: "gain",
}


def encode_air(report: AirReport) -> dict[str, Any]:
    """A std_msgs/Float64MultiArray per topic: [uav], or [uav, uav] from row to column."""
    from std_msgs.msg import Float64MultiArray

    label = multi_array.stamped_uav_label(report.uav_ids, report.stamp_ns)
    messages = {}
    for topic, name in ARRAY_OF_TOPIC.items():
        array = getattr(report, name)
        messages[topic] = multi_array.fill(Float64MultiArray(), array, (label,) * array.ndim)
    return messages


def decode_air_array(message: Any, rank: int) -> AirArray:
    """Stamp (ns since the epoch), UAVs and values of one of the air's messages.

    `rank` is 1 or 2. Raises MessageError naming the field at fault.
    """
    shape, names = multi_array.shape_and_labels(message, rank)
    stamp_ns, uav_ids = multi_array.parse_stamped_uav_label(names[0], shape[0])
    if any(name != names[0] for name in names) or len(set(shape)) != 1:
        raise MessageError("layout.dim[1]", "is of other UAVs than layout.dim[0]")
    array = multi_array.values(message, shape, np.float64)
    if not (np.isfinite(array).all() and (array >= 0).all()):
        raise MessageError("data", "holds values that are negative or not finite")
    return AirArray(stamp_ns, uav_ids, array)


def decode_air(messages: dict[str, Any]) -> AirReport:
    """The report that a message per topic makes up. Raises MessageError naming what is wrong."""
    arrays = {}
    heads = set()
    for topic, name in ARRAY_OF_TOPIC.items():
        rank = 1 if name in ("power_w", "energy_j") else 2
        stamp_ns, uav_ids, arrays[name] = decode_air_array(messages[topic], rank)
        heads.add((stamp_ns, uav_ids))
    if len(heads) != 1:
        raise MessageError("layout.dim.label", "is not the same on all topics of the air")
    stamp_ns, uav_ids = heads.pop()
    return AirReport(stamp_ns=stamp_ns, uav_ids=uav_ids, **arrays)


def encode_energy_left(stamp_ns: int, left_j: dict[str, float]) -> Any:
    """std_msgs/Float64MultiArray [uav] in J of the energy left to each UAV's radio."""
    from std_msgs.msg import Float64MultiArray

    label = multi_array.stamped_uav_label(tuple(left_j), stamp_ns)
    return multi_array.fill(Float64MultiArray(), np.array(list(left_j.values())), (label,))


def decode_energy_left(message: Any) -> dict[str, float]:
    """Energy left to each UAV's radio, J. Raises MessageError naming the field at fault."""
    _, uav_ids, left_j = decode_air_array(message, 1)
    return dict(zip(uav_ids, left_j.tolist(), strict=True))
