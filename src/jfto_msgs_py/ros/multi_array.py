"""numpy arrays as std_msgs multi-arrays."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from jfto_msgs_py.errors import MessageError


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
