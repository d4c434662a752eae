"""Energy left to the radios as a multi-array, `uav;ids=uav1,uav2;t=1763776800.250000000`."""

from __future__ import annotations

from typing import Any

import numpy as np

from jfto_msgs_py.ros import labels, multi_array
from jfto_msgs_py.ros.air import decode_air_array


def encode_energy_left(stamp_ns: int, left_j: dict[str, float]) -> Any:
    """std_msgs/Float64MultiArray [uav] in J of the energy left to each UAV's radio."""
    from std_msgs.msg import Float64MultiArray

    label = labels.stamped_uav_label(tuple(left_j), stamp_ns)
    return multi_array.fill(Float64MultiArray(), np.array(list(left_j.values())), (label,))


def decode_energy_left(message: Any) -> dict[str, float]:
    """Energy left to each UAV's radio, J. Raises MessageError naming the field at fault."""
    _, uav_ids, left_j = decode_air_array(message, 1)
    return dict(zip(uav_ids, left_j.tolist(), strict=True))
