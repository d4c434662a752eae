"""Routes to trajectories: quintic Bezier segments of least total time. See docs/trajectories.md."""

from jfto_planner.smoothing.bounds import rest_to_rest_s, straight_line_s
from jfto_planner.smoothing.hull import limit_ratios
from jfto_planner.smoothing.limits import CurveLimits, photo_speed_mps
from jfto_planner.smoothing.smooth import (
    RouteRequest,
    SmoothingSettings,
    smooth_route,
    smooth_routes,
)
from jfto_planner.smoothing.trajectory import Motion, Trajectory

__all__ = [
    "CurveLimits",
    "Motion",
    "RouteRequest",
    "SmoothingSettings",
    "Trajectory",
    "limit_ratios",
    "photo_speed_mps",
    "rest_to_rest_s",
    "smooth_route",
    "smooth_routes",
    "straight_line_s",
]
