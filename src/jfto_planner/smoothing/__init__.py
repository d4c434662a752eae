"""Routes to trajectories: quintic Bezier segments of least total time.

See docs/explanation/trajectories.md.
"""

from jfto_planner.smoothing.fleet import CurveRules, kept_apart, smooth_fleet
from jfto_planner.smoothing.limits import CurveLimits, photo_speed_mps, rest_to_rest_s
from jfto_planner.smoothing.separation import SeparationSettings, separate
from jfto_planner.smoothing.smooth import RouteRequest, SmoothingSettings, smooth_route
from jfto_planner.smoothing.terrain import Clearance, smooth_above
from jfto_planner.smoothing.time_model import SmoothFlight
from jfto_planner.smoothing.trajectory import Motion, Trajectory

__all__ = [
    "Clearance",
    "CurveLimits",
    "CurveRules",
    "Motion",
    "RouteRequest",
    "SeparationSettings",
    "SmoothFlight",
    "SmoothingSettings",
    "Trajectory",
    "kept_apart",
    "photo_speed_mps",
    "rest_to_rest_s",
    "separate",
    "smooth_above",
    "smooth_fleet",
    "smooth_route",
]
