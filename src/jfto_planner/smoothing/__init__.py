"""Routes to trajectories: quintic Bezier segments of least total time.

See docs/explanation/trajectories.md.
"""

from jfto_planner.smoothing.fleet import CurveRules, kept_apart, smooth_fleet
from jfto_planner.smoothing.hull import limit_ratios
from jfto_planner.smoothing.limits import (
    CurveLimits,
    photo_speed_mps,
    rest_to_rest_s,
    straight_line_s,
)
from jfto_planner.smoothing.separation import (
    Approach,
    SeparationSettings,
    closest_approach,
    separate,
)
from jfto_planner.smoothing.smooth import (
    RouteRequest,
    SmoothingSettings,
    smooth_route,
    smooth_routes,
)
from jfto_planner.smoothing.terrain import Clearance, least_clearance_m, smooth_above
from jfto_planner.smoothing.time_model import SmoothFlight
from jfto_planner.smoothing.trajectory import Motion, Trajectory

__all__ = [
    "Approach",
    "Clearance",
    "CurveLimits",
    "CurveRules",
    "Motion",
    "RouteRequest",
    "SeparationSettings",
    "SmoothFlight",
    "SmoothingSettings",
    "Trajectory",
    "closest_approach",
    "kept_apart",
    "least_clearance_m",
    "limit_ratios",
    "photo_speed_mps",
    "rest_to_rest_s",
    "separate",
    "smooth_above",
    "smooth_fleet",
    "smooth_route",
    "smooth_routes",
    "straight_line_s",
]
