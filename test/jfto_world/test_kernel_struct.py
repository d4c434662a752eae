"""Rules of the records that kernels take as one pointer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags, Ints
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct


@dataclass(frozen=True, eq=False)
class Inside(KernelStruct):
    values: Array
    scale: float


@dataclass(frozen=True, eq=False)
class Outside(KernelStruct):
    first: Array
    inside: Inside
    flags: Flags
    count: int
    last: Ints


@inner
def _scaled(inside: Inside, k: int) -> float:
    return inside.values[k] * inside.scale


@kernel
def _fill(record: Outside) -> None:
    for i in range(record.first.shape[0]):
        for j in range(record.first.shape[1]):
            if record.flags[j]:
                record.first[i, j] += _scaled(record.inside, j) * record.count
    record.last[0] = record.first.shape[1]


def _record(columns: int, scale: float) -> Outside:
    inside = Inside(np.arange(columns, dtype=np.float64), scale)
    flags = np.arange(columns) % 2 == 1
    return Outside(np.ones((2, columns)), inside, flags, 3, np.zeros(1, dtype=np.int64))


def test_a_kernel_reads_every_kind_of_field_and_writes_into_arrays():
    """Arrays of any rank and kind, numbers and records within records arrive as they are."""
    record = _record(4, 0.5)
    _fill(record)
    assert record.first.tolist() == [[1.0, 2.5, 1.0, 5.5]] * 2
    assert record.last.tolist() == [4]


def test_records_of_other_sizes_and_numbers_need_no_other_code():
    """Shapes and numbers are read from the record, so that one compilation serves all."""
    for columns, scale in ((2, 1.0), (3, -2.0)):
        record = _record(columns, scale)
        _fill(record)
        assert record.first[0, 1] == 1.0 + 3 * scale
        assert record.last[0] == columns
    assert len(_fill.signatures) == 1


def test_a_literal_number_makes_no_copy_of_an_inner_function():
    """Calls with different literal numbers share one compilation."""

    @inner
    def add(a: int, b: int) -> int:
        return a + b

    @kernel
    def total(a: int) -> int:
        return add(a, 1) + add(2, a) + add(3, 4)

    assert total(10) == 30
    assert len(add.overloads) == 1
