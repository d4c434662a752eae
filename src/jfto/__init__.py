"""Plan and fly multirotors that keep a live mesh; `jfto.api` is what a notebook sees."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_msgs_py.lazy import lazy_names

if TYPE_CHECKING:
    from jfto.api import compare, cover, load_scenario, plan, plan_sorties, power, report, topology

__version__ = "0.1.0"
__all__ = [
    "__version__",
    "compare",
    "cover",
    "load_scenario",
    "plan",
    "plan_sorties",
    "power",
    "report",
    "topology",
]


__getattr__ = lazy_names("jfto", dict.fromkeys(__all__[1:], "jfto.api"))
