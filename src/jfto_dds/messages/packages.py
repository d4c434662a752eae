"""Message packages as importable modules: ``std_msgs.msg``, ``std_srvs.srv._trigger``, ..."""

from __future__ import annotations

import functools
import types
from typing import Any

from jfto_dds.messages.definitions import packages, type_names
from jfto_dds.messages.message_class import message_class, module_name
from jfto_dds.messages.service_class import service_class
from jfto_dds.messages.services import SERVICES


@functools.cache
def _types_by_module() -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for full_name in type_names():
        package, kind, _ = full_name.split("/")
        found.setdefault(f"{package}.{kind}", []).append(full_name)
        found.setdefault(module_name(full_name), []).append(full_name)
    return {name: tuple(full_names) for name, full_names in found.items()}


def is_message_module(name: str) -> bool:
    """Whether a module name belongs to a message package that is known here."""
    return name in packages() or name in _types_by_module()


def is_message_package(name: str) -> bool:
    """Whether a module has submodules: a package or its ``msg`` or ``srv``."""
    return name in packages() or name.count(".") == 1


def _exports(full_name: str) -> dict[str, str]:
    name = full_name.split("/")[2]
    exports = {name: full_name}
    if full_name in SERVICES:
        for half in ("Request", "Response", "Event"):
            exports[f"{name}_{half}"] = f"{full_name}_{half}"
    return exports


def fill_module(module: types.ModuleType) -> None:
    """Give a message module its classes, each built when it is first asked for."""
    known = {
        attribute: full_name
        for listed in _types_by_module().get(module.__name__, ())
        for attribute, full_name in _exports(listed).items()
    }

    def __getattr__(attribute: str) -> Any:  # noqa: N807
        if attribute not in known:
            msg = f"module {module.__name__!r} has no attribute {attribute!r}"
            raise AttributeError(msg)
        full_name = known[attribute]
        build = service_class if full_name in SERVICES else message_class
        value = build(full_name)
        setattr(module, attribute, value)
        return value

    module.__getattr__ = __getattr__  # type: ignore[method-assign]
    module.__dir__ = lambda: sorted({*module.__dict__, *known})  # type: ignore[method-assign]
    module.__all__ = sorted(known)  # type: ignore[attr-defined]
