"""Builds the Python class of a service type."""

from __future__ import annotations

import functools
from typing import Any

from jfto_dds.messages.message_class import message_class, module_name
from jfto_dds.messages.type_support import TypeSupport


def _refuse(cls: type) -> None:
    msg = "Service classes can not be instantiated"
    raise NotImplementedError(msg)


@functools.cache
def service_class(full_name: str) -> Any:
    """Build (once) the class of a service: its Request, Response and Event classes."""
    name = full_name.split("/")[2]
    support = TypeSupport(full_name)
    metaclass = type(
        f"Metaclass_{name}",
        (type,),
        {
            "_TYPE_SUPPORT": property(lambda _cls: support),
            "__module__": module_name(full_name),
            "__doc__": f"Metaclass of service '{name}'.",
        },
    )
    members = {
        half: message_class(f"{full_name}_{half}") for half in ("Request", "Response", "Event")
    }
    members["__module__"] = module_name(full_name)
    members["__doc__"] = f"Service class '{name}'."
    members["__init__"] = _refuse
    return metaclass(name, (), members)
