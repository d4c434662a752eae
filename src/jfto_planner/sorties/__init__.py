"""Which waypoints are flown in which sortie, where one flight does not do for all of them."""

from jfto_planner.sorties.balance import Load, Split, balanced
from jfto_planner.sorties.bounds import least_by_time
from jfto_planner.sorties.divide import divide

__all__ = ["Load", "Split", "balanced", "divide", "least_by_time"]
