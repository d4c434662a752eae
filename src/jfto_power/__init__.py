"""Decides how loudly each UAV transmits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_msgs_py.lazy import lazy_names

if TYPE_CHECKING:
    from jfto_power.allocation import Allocation, PowerProblem, allocate, allocate_prefix

__all__ = ["Allocation", "PowerProblem", "allocate", "allocate_prefix"]
__getattr__ = lazy_names(
    __name__,
    {
        "Allocation": "jfto_power.allocation",
        "PowerProblem": "jfto_power.allocation",
        "allocate": "jfto_power.allocation",
        "allocate_prefix": "jfto_power.allocation",
    },
)
