"""Records of arrays that a kernel takes as one pointer.

numba takes a named tuple apart: each of its arrays becomes five to nine arguments of every function
that it is handed to, and a dozen arrays make a function that takes longer to compile for its
arguments than for what it does. A `KernelStruct` is handed on by its address.
"""

from __future__ import annotations

import hashlib
import struct
from dataclasses import fields
from functools import cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import typeof, types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

_WORD = ir.IntType(64)
# numba's description of an array: owner twice, item count and size, address, shape, strides.
_OWNER = [0, 0]


class KernelStruct:
    """Base of frozen dataclasses whose fields are arrays, numbers and other KernelStructs.

    Kernels read the fields and may write into the arrays. They see the arrays that the fields held
    when a kernel took the record for the first time.
    """

    @property
    def _address(self) -> int:
        memory = self.__dict__.get("_memory")
        if memory is None:
            words: list[int] = []
            for field in fields(self):  # type: ignore[arg-type]
                words += _words(getattr(self, field.name))
            # The first of several threads makes what all of them use.
            memory = self.__dict__.setdefault("_memory", np.array(words, dtype=np.int64))
        return int(memory.ctypes.data)


def _words(value: Any) -> list[int]:
    """A value as the 8-byte words of its memory in compiled code."""
    if isinstance(value, np.ndarray):
        address = value.__array_interface__["data"][0]
        return [*_OWNER, value.size, value.itemsize, address, *value.shape, *value.strides]
    if isinstance(value, KernelStruct):
        return [value._address]
    if isinstance(value, float):
        return [*struct.unpack("q", struct.pack("d", value))]
    return [int(value)]


class StructType(types.Type):
    """Type of a KernelStruct for the compiler: the names and types of its fields."""

    def __init__(self, name: str, members: tuple[tuple[str, types.Type], ...]) -> None:
        self.members = members
        # Short, since it becomes part of the name of every function that takes one.
        digest = hashlib.sha256(repr(members).encode()).hexdigest()[:8]
        super().__init__(name=f"{name}_{digest}")

    def offset(self, attribute: str) -> int:
        """Number of words before a field."""
        count = 0
        for name, kind in self.members:
            if name == attribute:
                break
            count += len(_OWNER) + 3 + 2 * kind.ndim if isinstance(kind, types.Array) else 1
        return count


@register_model(StructType)
class _Model(models.OpaqueModel):
    pass


@typeof_impl.register(KernelStruct)
def _typeof(value: KernelStruct, _context: Any) -> StructType:
    names = tuple(field.name for field in fields(value))  # type: ignore[arg-type]
    return _struct_type(
        type(value).__name__, names, tuple(typeof(getattr(value, n)) for n in names)
    )


@cache
def _struct_type(name: str, names: tuple[str, ...], kinds: tuple[types.Type, ...]) -> StructType:
    return StructType(name, tuple(zip(names, kinds, strict=True)))


@unbox(StructType)
def _unbox(_type: StructType, value: Any, c: Any) -> NativeValue:
    address = c.pyapi.object_getattr_string(value, "_address")
    pointer = c.pyapi.long_as_voidptr(address)
    c.pyapi.decref(address)
    return NativeValue(pointer)


@infer_getattr
class _Attributes(AttributeTemplate):
    key = StructType

    def generic_resolve(self, value: StructType, attr: str) -> Any:  # type: ignore[override]
        return dict(value.members).get(attr)


@lower_getattr_generic(StructType)
def _read(context: Any, builder: Any, kind: StructType, value: Any, attribute: str) -> Any:
    words = builder.bitcast(value, _WORD.as_pointer())
    place = kind.offset(attribute)
    member = dict(kind.members)[attribute]
    if not isinstance(member, types.Array):
        return _load(builder, words, place, context.get_value_type(member))
    array = cgutils.create_struct_proxy(member)(context, builder)
    count = member.ndim
    array.nitems = _load(builder, words, place + 2, _WORD)
    array.itemsize = ir.Constant(_WORD, context.get_abi_sizeof(context.get_data_type(member.dtype)))
    array.data = _load(builder, words, place + 4, array.data.type)
    shape = [_load(builder, words, place + 5 + axis, _WORD) for axis in range(count)]
    strides = [_load(builder, words, place + 5 + count + axis, _WORD) for axis in range(count)]
    array.shape = cgutils.pack_array(builder, shape, _WORD)
    array.strides = cgutils.pack_array(builder, strides, _WORD)
    return array._getvalue()


def _load(builder: Any, words: Any, place: int, kind: Any) -> Any:
    """The word at a place, as a value of a kind."""
    address = builder.gep(words, [ir.Constant(_WORD, place)])
    loaded = builder.load(builder.bitcast(address, kind.as_pointer()))
    # Fields never change: what is read need not be read again after every write to memory.
    loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
    return loaded
