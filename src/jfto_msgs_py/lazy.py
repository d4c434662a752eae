"""Names that a package exports without loading what they need: numba alone takes half a second."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any


def lazy_names(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """The package's `__getattr__` for names by the modules that define them.

    `dir()` of the package then lists what it exports, loaded or not, and its loaded modules.
    """

    def get(name: str) -> Any:
        home = homes.get(name)
        if home is None:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(home), name)

    def listed() -> list[str]:
        held = vars(sys.modules[package])
        own = (n for n, v in held.items() if n.startswith("__") or isinstance(v, ModuleType))
        return sorted({*held.get("__all__", ()), *homes, *own} - {"__dir__"})

    vars(sys.modules[package])["__dir__"] = listed
    return get
