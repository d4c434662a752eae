"""Where to take photos, and what they show."""

from jfto_planner.coverage.camera import Camera
from jfto_planner.coverage.certificate import CoverageCertificate, certify_coverage
from jfto_planner.coverage.overlaps import Overlaps, PairOverlaps, measure_overlaps
from jfto_planner.coverage.placer import CoverageNote
from jfto_planner.coverage.places import Assumed, Places, Spot
from jfto_planner.coverage.plan_coverage import Coverage, judge_waypoints, plan_coverage
from jfto_planner.coverage.random_waypoints import random_waypoints
from jfto_planner.coverage.settings import CoverageSettings
from jfto_planner.coverage.waypoint_file import WaypointSet, read_waypoint_set, read_waypoints

__all__ = [
    "Assumed",
    "Camera",
    "Coverage",
    "CoverageCertificate",
    "CoverageNote",
    "CoverageSettings",
    "Overlaps",
    "PairOverlaps",
    "Places",
    "Spot",
    "WaypointSet",
    "certify_coverage",
    "judge_waypoints",
    "measure_overlaps",
    "plan_coverage",
    "random_waypoints",
    "read_waypoint_set",
    "read_waypoints",
]
