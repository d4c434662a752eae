"""numpy arrays as multi-arrays that describe themselves in the labels of their dimensions.

A label is `name;key=value;…` or `name;a,b;unit=W`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.network import SlotHorizon

BOUND_LABEL = "bound;min,max;unit=W"


def fill(message: Any, array: NDArray[Any], labels: tuple[str, ...]) -> Any:
    """Put a C-ordered array with one label per dimension into a multi-array message."""
    from std_msgs.msg import MultiArrayDimension

    message.layout.dim = [
        MultiArrayDimension(label=label, size=size, stride=math.prod(array.shape[axis:]))
        for axis, (label, size) in enumerate(zip(labels, array.shape, strict=True))
    ]
    message.layout.data_offset = 0
    message.data = array.ravel().tolist()
    return message


def shape_and_labels(message: Any, rank: int) -> tuple[tuple[int, ...], tuple[str, ...]]:
    """Shape and labels of a multi-array. Raises MessageError if it contradicts itself."""
    dims = message.layout.dim
    if len(dims) != rank:
        raise MessageError("layout.dim", f"has {len(dims)} dimensions, expected {rank}")
    shape = tuple(int(dim.size) for dim in dims)
    expected = math.prod(shape)
    if message.layout.data_offset != 0:
        raise MessageError("layout.data_offset", f"is {message.layout.data_offset}, expected 0")
    if len(message.data) != expected:
        raise MessageError("data", f"holds {len(message.data)} values, {shape} needs {expected}")
    for axis, dim in enumerate(dims):
        stride = math.prod(shape[axis:])
        if dim.stride != stride:
            raise MessageError(f"layout.dim[{axis}].stride", f"is {dim.stride}, expected {stride}")
    return shape, tuple(dim.label for dim in dims)


def values(message: Any, shape: tuple[int, ...], dtype: DTypeLike) -> NDArray[Any]:
    """Data of a multi-array in its shape."""
    return np.asarray(message.data, dtype=dtype).reshape(shape)


def slot_label(horizon: SlotHorizon) -> str:
    """Label of the slot dimension: `slot;first=45;t0=1763776800.250000000;dt=3.0`."""
    return f"slot;first={horizon.first};t0={_seconds(horizon.t0_ns)};dt={horizon.duration_s!r}"


def parse_slot_label(label: str, count: int) -> SlotHorizon:
    """Horizon that a slot label describes. Raises MessageError naming the faulty part."""
    values = _fields(label, "slot", ("first", "t0", "dt"))
    try:
        first = int(values["first"])
    except ValueError:
        raise MessageError("slot.first", f"{values['first']!r} is not a whole number") from None
    try:
        duration_s = float(values["dt"])
    except ValueError:
        raise MessageError("slot.dt", f"{values['dt']!r} is not a number") from None
    return SlotHorizon(first, _nanoseconds("slot.t0", values["t0"]), duration_s, count)


def uav_label(uav_ids: tuple[str, ...]) -> str:
    """Label of a UAV dimension: `uav;ids=uav1,uav2`."""
    return "uav;ids=" + ",".join(uav_ids)


def parse_uav_label(label: str, size: int) -> tuple[str, ...]:
    """UAV ids of a label. Raises MessageError if they are not `size` many."""
    ids = tuple(_fields(label, "uav", ("ids",))["ids"].split(","))
    if len(ids) != size:
        raise MessageError("uav.ids", f"names {len(ids)} UAVs for a dimension of size {size}")
    return ids


def stamped_uav_label(uav_ids: tuple[str, ...], stamp_ns: int) -> str:
    """Label of UAVs at one moment: `uav;ids=uav1,uav2;t=1763776800.250000000`."""
    return f"{uav_label(uav_ids)};t={_seconds(stamp_ns)}"


def parse_stamped_uav_label(label: str, size: int) -> tuple[int, tuple[str, ...]]:
    """Stamp in ns and UAV ids of a label. Raises MessageError naming the faulty part."""
    values = _fields(label, "uav", ("ids", "t"))
    return _nanoseconds("uav.t", values["t"]), parse_uav_label(label, size)


def _seconds(stamp_ns: int) -> str:
    seconds, nanoseconds = divmod(stamp_ns, 10**9)
    return f"{seconds}.{nanoseconds:09d}"


def _nanoseconds(field: str, text: str) -> int:
    """Exact nanoseconds of a decimal number of seconds: a float would round them."""
    whole, _, fraction = text.partition(".")
    if not whole.isdecimal() or (fraction and not fraction.isdecimal()) or len(fraction) > 9:
        raise MessageError(field, f"{text!r} is not seconds with at most 9 decimals")
    return int(whole) * 10**9 + int(fraction.ljust(9, "0") or 0)


def _fields(label: str, name: str, keys: tuple[str, ...]) -> dict[str, str]:
    head, *rest = label.split(";")
    if head != name:
        raise MessageError("layout.dim.label", f"{label!r} should begin with {name!r}")
    values = dict(part.split("=", 1) for part in rest if "=" in part)
    for key in keys:
        if key not in values:
            raise MessageError("layout.dim.label", f"{label!r} lacks {key}=")
    return values
