"""Decides where each UAV flies: coverage, starting points, routes and their certificate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_msgs_py.lazy import lazy_names

if TYPE_CHECKING:
    from jfto_planner.routing import (
        RoutingProblem,
        SearchResult,
        SearchSettings,
        certify,
        plan_of,
        search,
    )

__all__ = ["RoutingProblem", "SearchResult", "SearchSettings", "certify", "plan_of", "search"]
__getattr__ = lazy_names(__name__, dict.fromkeys(__all__, "jfto_planner.routing"))
