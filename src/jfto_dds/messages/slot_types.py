"""The ``rosidl_parser.definition`` classes that ``SLOT_TYPES`` of a message class holds."""

from __future__ import annotations

import types

from jfto_dds.messages.definitions import FieldType


class AbstractType:
    """Base of all field types."""


class BasicType(AbstractType):
    """A primitive; ``typename`` is its IDL name."""

    def __init__(self, typename: str) -> None:
        self.typename = typename


class NamespacedType(AbstractType):
    """Another message type."""

    def __init__(self, namespaces: list[str], name: str) -> None:
        self.namespaces = namespaces
        self.name = name

    def namespaced_name(self) -> tuple[str, ...]:
        """Package, kind and name as a tuple."""
        return (*self.namespaces, self.name)


class UnboundedString(AbstractType):
    """A string of any length."""


class BoundedString(AbstractType):
    """A string of at most ``maximum_size`` characters."""

    def __init__(self, maximum_size: int) -> None:
        self.maximum_size = maximum_size


class AbstractNestedType(AbstractType):
    """A container of ``value_type``."""

    def __init__(self, value_type: AbstractType) -> None:
        self.value_type = value_type


class Array(AbstractNestedType):
    """A container of exactly ``size`` elements."""

    def __init__(self, value_type: AbstractType, size: int) -> None:
        super().__init__(value_type)
        self.size = size


class AbstractSequence(AbstractNestedType):
    """A container of variable length."""


class UnboundedSequence(AbstractSequence):
    """A container of any length."""


class BoundedSequence(AbstractSequence):
    """A container of at most ``maximum_size`` elements."""

    def __init__(self, value_type: AbstractType, maximum_size: int) -> None:
        super().__init__(value_type)
        self.maximum_size = maximum_size


def slot_type(field: FieldType) -> AbstractType:
    """Describe a field as rosidl_parser does."""
    element: AbstractType
    if field.is_message:
        package, kind, name = field.name.split("/")
        element = NamespacedType([package, kind], name)
    elif field.name == "string":
        element = BoundedString(field.bound) if field.bound else UnboundedString()
    else:
        element = BasicType(field.name)
    if field.container == "array":
        return Array(element, field.size)
    if field.container == "sequence":
        return BoundedSequence(element, field.size) if field.size else UnboundedSequence(element)
    return element


_EXPORTED: tuple[type, ...] = (
    AbstractType,
    BasicType,
    NamespacedType,
    UnboundedString,
    BoundedString,
    AbstractNestedType,
    Array,
    AbstractSequence,
    UnboundedSequence,
    BoundedSequence,
)
for _class in _EXPORTED:
    # Programs know these classes, and print them, by the name of their ROS module.
    _class.__module__ = "rosidl_parser.definition"


def fill_rosidl_parser(module: types.ModuleType) -> None:
    """Give ``rosidl_parser.definition`` its contents."""
    for exported in _EXPORTED:
        setattr(module, exported.__name__, exported)
