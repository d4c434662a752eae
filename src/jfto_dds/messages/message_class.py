"""Builds the Python class of a message type, with the behaviour of rosidl_python's classes."""

from __future__ import annotations

import array
import functools
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from jfto_dds.messages.definitions import Definition, FieldType, definition
from jfto_dds.messages.field_checks import Check, check_container, check_element
from jfto_dds.messages.layout import NUMERIC, NUMPY_CODE, STRUCT_CODE
from jfto_dds.messages.slot_types import slot_type
from jfto_dds.messages.type_support import TypeSupport

_ZERO: dict[str, object] = {"boolean": False, "octet": b"\x00", "string": ""}


def snake_case(name: str) -> str:
    """Turn ``PoseStamped`` into ``pose_stamped``, as rosidl names modules."""
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def module_name(full_name: str) -> str:
    """Name the module that defines a type, ``std_srvs.srv._trigger`` of ``.../Trigger_Request``."""
    package, kind, name = full_name.split("/")
    if kind == "srv":
        name = re.sub(r"_(Request|Response|Event)$", "", name)
    return f"{package}.{kind}._{snake_case(name)}"


def _container_factory(field: FieldType) -> Callable[[], Any]:
    numeric = field.name in NUMERIC
    if field.container == "sequence":
        code = STRUCT_CODE.get(field.name, "")
        return (lambda: array.array(code)) if numeric else list
    if numeric:
        dtype = np.dtype(NUMPY_CODE[field.name])
        return lambda: np.zeros(field.size, dtype=dtype)
    element = _default_factory(FieldType(field.name), None)
    return lambda: [element() for _ in range(field.size)]


def _default_factory(field: FieldType, given: object) -> Callable[[], Any]:
    if given is not None:
        return lambda: given
    if field.container:
        return _container_factory(field)
    if field.is_message:
        return message_class(field.name)
    zero = _ZERO.get(field.name, 0.0 if field.name in ("float", "double") else 0)
    return lambda: zero


def _field_check(field: FieldType, label: str) -> Check:
    nested = message_class(field.name) if field.is_message else None
    if field.container:
        return check_container(field, label, nested)
    return check_element(field.name, field.bound, label, nested)


def _property(label: str, slot: str, check: Check) -> property:
    def read(self: Any) -> Any:
        return getattr(self, slot)

    def write(self: Any, value: Any) -> None:
        setattr(self, slot, check(value))

    return property(read, write, doc=f"Message field '{label}'.")


def _make_init(meaning: Definition) -> Callable[..., None]:
    plan = [
        (name, f"_{name}", _default_factory(field, meaning.defaults.get(name)))
        for name, field in meaning.fields
    ]
    known = frozenset(name for name, _, _ in plan) | {"check_fields"}

    def __init__(self: Any, **kwargs: Any) -> None:  # noqa: N807
        unknown = kwargs.keys() - known
        assert not unknown, "Invalid arguments passed to constructor: " + ", ".join(sorted(unknown))
        self._check_fields = True
        for name, slot, default in plan:
            if name in kwargs:
                setattr(self, name, kwargs[name])
            else:
                setattr(self, slot, default())

    __init__.__qualname__ = f"{meaning.name}.__init__"
    return __init__


def _field_repr(field: FieldType, value: Any) -> str:
    text = repr(value)
    if field.container == "sequence" and field.name in NUMERIC:
        # The array.array around a sequence is not shown.
        return text[len("array('d', ") : -1] if len(value) else "[]"
    return text


def _make_repr(meaning: Definition) -> Callable[[Any], str]:
    title = meaning.full_name.replace("/", ".")

    def __repr__(self: Any) -> str:  # noqa: N807
        parts = [
            f"{name}={_field_repr(field, getattr(self, '_' + name))}"
            for name, field in meaning.fields
        ]
        return f"{title}({', '.join(parts)})"

    return __repr__


def _make_eq(meaning: Definition) -> Callable[[Any, object], bool]:
    plan = [
        (f"_{name}", field.container == "array" and field.name in NUMERIC)
        for name, field in meaning.fields
    ]

    def __eq__(self: Any, other: object) -> bool:  # noqa: N807
        if not isinstance(other, type(self)):
            return False
        for slot, is_numpy in plan:
            mine, theirs = getattr(self, slot), getattr(other, slot)
            if is_numpy:
                if not np.array_equal(mine, theirs):
                    return False
            elif mine != theirs:
                return False
        return True

    return __eq__


def _constant_value(kind: str, value: Any) -> Any:
    return bytes([value]) if kind == "octet" else value


def _constant(name: str, value: Any) -> property:
    return property(lambda _cls: value, doc=f"Message constant '{name}'.")


def _metaclass(meaning: Definition, constants: dict[str, Any]) -> type:
    support = TypeSupport(meaning.full_name)
    members: dict[str, Any] = {name: _constant(name, value) for name, value in constants.items()}
    members["_TYPE_SUPPORT"] = property(lambda _cls: support)
    members["__module__"] = module_name(meaning.full_name)
    members["__doc__"] = f"Metaclass of message '{meaning.name}'."
    return type(f"Metaclass_{meaning.name}", (type,), members)


@functools.cache
def message_class(full_name: str) -> Any:
    """Build (once) the class of a message or of one half of a service."""
    meaning = definition(full_name)
    constants = {name: _constant_value(kind, value) for name, kind, value in meaning.constants}
    types = {name: str(field) for name, field in meaning.fields}
    members: dict[str, Any] = {
        **constants,
        "__slots__": [*(f"_{name}" for name in types), "_check_fields"],
        "_fields_and_field_types": types,
        "SLOT_TYPES": tuple(slot_type(field) for _, field in meaning.fields),
        "__init__": _make_init(meaning),
        "__repr__": _make_repr(meaning),
        "__eq__": _make_eq(meaning),
        "__hash__": None,
        "__module__": module_name(full_name),
        "__doc__": f"Message class '{meaning.name}'.",
        "get_fields_and_field_types": classmethod(lambda cls: dict(cls._fields_and_field_types)),
    }
    for name, field in meaning.fields:
        members[name] = _property(name, f"_{name}", _field_check(field, name))
    return _metaclass(meaning, constants)(meaning.name, (), members)
