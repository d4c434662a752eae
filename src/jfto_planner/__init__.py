"""Decides where each UAV flies: coverage, starting points, routes and their certificate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_msgs_py.lazy import lazy_names

if TYPE_CHECKING:
    from jfto_planner.routing import RoutingProblem, SearchResult, SearchSettings, certify, search

__all__ = ["RoutingProblem", "SearchResult", "SearchSettings", "certify", "search"]
__getattr__ = lazy_names(
    __name__,
    {
        "RoutingProblem": "jfto_planner.routing",
        "SearchResult": "jfto_planner.routing",
        "SearchSettings": "jfto_planner.routing",
        "certify": "jfto_planner.routing",
        "search": "jfto_planner.routing",
    },
)
