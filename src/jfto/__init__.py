"""Plan and fly multirotors that keep a live mesh; `jfto.api` is what a notebook sees."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jfto.api import compare, cover, load_scenario, plan, power, topology

__version__ = "0.1.0"
__all__ = ["__version__", "compare", "cover", "load_scenario", "plan", "power", "topology"]


def __getattr__(name: str) -> Any:
    """A function of the Python face, loaded when it is first asked for."""
    if name in __all__:
        from jfto import api

        return getattr(api, name)
    raise AttributeError(f"module 'jfto' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*globals(), *__all__]
