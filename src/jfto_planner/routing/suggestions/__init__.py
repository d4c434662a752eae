"""What would make an infeasible routing problem feasible, tried out and not guessed."""

from jfto_planner.routing.suggestions.budgets import Cure
from jfto_planner.routing.suggestions.suggest import suggest_cures

__all__ = ["Cure", "suggest_cures"]
