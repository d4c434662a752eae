"""The routing problem (P1), its search and the certificate of a plan."""

from jfto_planner.routing.build_plan import PlanTerms, build_plan, plan_of, with_passed
from jfto_planner.routing.certificate import certify
from jfto_planner.routing.estimated import Calibrated, Estimated, calibrated
from jfto_planner.routing.problem import RoutingProblem
from jfto_planner.routing.search import SearchResult, search
from jfto_planner.routing.settings import SearchSettings
from jfto_planner.routing.suggestions import Cure, suggest_cures

__all__ = [
    "Calibrated",
    "Cure",
    "Estimated",
    "PlanTerms",
    "RoutingProblem",
    "SearchResult",
    "SearchSettings",
    "build_plan",
    "calibrated",
    "certify",
    "plan_of",
    "search",
    "suggest_cures",
    "with_passed",
]
