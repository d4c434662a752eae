"""What each field of a message accepts, with the words of rosidl_python when it does not.

Jazzy runs these checks only under ``ROS_PYTHON_CHECK_FIELDS=1`` and otherwise sends an integer in
a float field as a denormal; here they always run.
"""

from __future__ import annotations

import array
import math
from collections import UserList, UserString
from collections.abc import Callable, Sequence, Set
from typing import Any

import numpy as np

from jfto_dds.messages.definitions import FieldType
from jfto_dds.messages.layout import NUMERIC, NUMPY_CODE, STRUCT_CODE

Check = Callable[[Any], Any]
_FLOAT_MAX = 3.402823466e38
_PYTHON_TYPE = {"boolean": "bool", "octet": "bytes", "float": "float", "double": "float"}


def _is_text(value: Any) -> bool:
    return isinstance(value, (str, UserString))


def _integer_range(name: str) -> tuple[int, int]:
    bits = int(name.lstrip("uint"))
    return (0, 2**bits - 1) if name[0] == "u" else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _in_float_range(name: str, value: float) -> bool:
    if name == "double":
        return True
    return -_FLOAT_MAX <= value <= _FLOAT_MAX or math.isinf(value) or math.isnan(value)


def check_element(name: str, bound: int, label: str, message_class: type | None) -> Check:
    """Build the check of a single value; it returns the value or raises AssertionError.

    ``label`` is the field's name, ``message_class`` the class that a message field demands.
    """
    prefix = f"The '{label}' field must be "

    def check_message(value: Any) -> Any:
        assert isinstance(value, message_class), (  # type: ignore[arg-type]
            f"{prefix}a sub message of type '{message_class.__name__}'"  # type: ignore[union-attr]
        )
        return value

    def check_string(value: Any) -> Any:
        if bound:
            fits = _is_text(value) and len(value) <= bound
            assert fits, f"{prefix}string value 'string<{bound}>' not longer than {bound}"
        assert _is_text(value), f"{prefix}of type 'str'"
        return value

    def check_octet(value: Any) -> Any:
        single = isinstance(value, (bytes, bytearray)) and len(value) == 1
        assert single, f"{prefix}of type 'bytes' or 'ByteString' with length 1"
        return value

    def check_boolean(value: Any) -> Any:
        assert isinstance(value, bool), f"{prefix}of type 'bool'"
        return value

    def check_float(value: Any) -> Any:
        assert isinstance(value, float), f"{prefix}of type 'float'"
        assert _in_float_range(name, value), (
            f"{prefix}a float in [-3.402823466e+38, 3.402823466e+38]"
        )
        return value

    def check_integer(value: Any) -> Any:
        assert isinstance(value, int), f"{prefix}of type 'int'"
        assert low <= value <= high, f"{prefix}{article} integer in [{low}, {high}]"
        return value

    if message_class is not None:
        return check_message
    special = {
        "string": check_string,
        "octet": check_octet,
        "boolean": check_boolean,
        "float": check_float,
        "double": check_float,
    }
    if name in special:
        return special[name]
    low, high = _integer_range(name)
    article = "an unsigned" if low == 0 else "an"
    return check_integer


def _element_words(name: str, message_class: type | None) -> str:
    if message_class is not None:
        return f"'{message_class.__name__}'"
    if name == "string":
        return "'str'"
    if name == "double":
        limit = f"{np.finfo(np.float64).max:f}"
        return f"'float' and each double in [-{limit}, {limit}]"
    if name == "float":
        limit = f"{_FLOAT_MAX:f}"
        return f"'float' and each float in [-{limit}, {limit}]"
    if name in _PYTHON_TYPE:
        return f"'{_PYTHON_TYPE[name]}'"
    low, high = _integer_range(name)
    kind = "unsigned integer" if low == 0 else "integer"
    return f"'int' and each {kind} in [{low}, {high}]"


def _element_test(name: str, bound: int, message_class: type | None) -> Callable[[Any], bool]:
    if message_class is not None:
        return lambda value: isinstance(value, message_class)
    if name == "string":
        return lambda value: _is_text(value) and (not bound or len(value) <= bound)
    if name == "octet":
        return lambda value: isinstance(value, bytes) and len(value) == 1
    if name == "boolean":
        return lambda value: isinstance(value, bool)
    if name in ("float", "double"):
        return lambda value: isinstance(value, float) and _in_float_range(name, value)
    low, high = _integer_range(name)
    return lambda value: isinstance(value, int) and low <= value <= high


def check_container(field: FieldType, label: str, message_class: type | None) -> Check:
    """Build the check of an array or sequence; it returns the value as rclpy stores it."""
    name, size = field.name, field.size
    fixed = field.container == "array"
    code = STRUCT_CODE.get(name, "")
    dtype = np.dtype(NUMPY_CODE[name]) if name in NUMERIC else None
    passes = _element_test(name, field.bound, message_class)
    length_words = f" with length {size}" if fixed else ""
    if size and not fixed:
        length_words = f" with length <= {size}"
    words = (
        f"The '{label}' field must be a set or sequence{length_words} and each value of type "
        + _element_words(name, message_class)
    )

    def fits(count: int) -> bool:
        return count == size if fixed else not size or count <= size

    def check_plain(value: Any) -> Any:
        valid = (
            isinstance(value, (Sequence, Set, UserList, array.array))
            and not _is_text(value)
            and fits(len(value))
            and all(map(passes, value))
        )
        assert valid, words
        return value

    def check_numbers(value: Any) -> Any:
        if isinstance(value, array.array):
            assert value.typecode == code, (
                f"The '{label}' array.array() must have the type code of '{code}'"
            )
            assert fits(len(value)), f"The '{label}' array.array() must have a size <= {size}"
            return value
        return array.array(code, check_plain(value))

    def check_fixed(value: Any) -> Any:
        if isinstance(value, np.ndarray):
            assert value.dtype == dtype, (
                f"The '{label}' numpy.ndarray() must have the dtype of 'numpy.{dtype}'"
            )
            assert value.size == size, f"The '{label}' numpy.ndarray() must have a size of {size}"
            return value
        return np.array(check_plain(value), dtype=dtype)

    if name not in NUMERIC:
        return check_plain
    return check_fixed if fixed else check_numbers
