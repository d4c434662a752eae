"""Curves outside of no-fly zones."""

import numpy as np
import shapely

from jfto_msgs_py.records.site import Fence, Zone
from jfto_planner.smoothing import CurveLimits, smooth_route
from jfto_planner.smoothing.smooth import RouteRequest
from jfto_planner.smoothing.terrain import Clearance, smooth_above
from jfto_world.site.free_space import FreeSpace

LIMITS = CurveLimits(8.0, 4.0, 3.0)
# A corner at the origin, and a zone on its outer side, where a smooth curve bulges.
POINTS = np.array([[-80.0, 0, 30], [0.0, 0, 30], [0.0, 80.0, 30], [-80.0, 80, 30]])
ZONE = ((-30.0, -40.0), (40.0, -40.0), (40.0, 40.0), (5.5, 40.0), (5.5, -5.5), (-30.0, -5.5))
FENCE = Fence((), (Zone("wall", ZONE),), 5.0)


def room_m(trajectory):
    """Least distance of a trajectory to the zone."""
    times = np.linspace(0, trajectory.knots_s[-1], 4000)
    places = shapely.points(trajectory.positions(times)[:, :2])
    return float(shapely.distance(shapely.Polygon(ZONE), places).min())


def test_a_curve_stops_where_it_would_enter_a_zone():
    """The free curve comes nearer than the margin, the one with a fence does not and is slower."""
    request = RouteRequest(POINTS, LIMITS)
    free = smooth_route(request)
    assert room_m(free) < 5.0
    kept = smooth_above(
        request, lambda x, _: 0.0 * x, Clearance(10.0), keep_out=FreeSpace(FENCE).blocked
    )
    assert room_m(kept) >= 5.0
    assert kept.knots_s[-1] > free.knots_s[-1]
    assert len(kept.waypoint_s) == len(POINTS)
