"""Writes one UAV's route as Litchi's mission table; heights are above its pad."""

from __future__ import annotations

import csv
import io

from jfto_msgs_py.mission_file.document import MissionTextError
from jfto_msgs_py.mission_file.geo_plan import GeoPlan

WAYPOINTS_MAX = 99
_ACTIONS = 15
_HEADER = (
    "latitude", "longitude", "altitude(m)", "heading(deg)", "curvesize(m)", "rotationdir",
    "gimbalmode", "gimbalpitchangle",
    *(f"{name}{k}" for k in range(1, _ACTIONS + 1) for name in ("actiontype", "actionparam")),
    "altitudemode", "speed(m/s)", "poi_latitude", "poi_longitude", "poi_altitude(m)",
    "poi_altitudemode", "photo_timeinterval", "photo_distinterval",
)  # fmt: skip
_TAKE_PHOTO, _NOTHING, _GIMBAL_ANGLE, _ABOVE_TAKE_OFF = 1, -1, 2, 0


def write_litchi(plan: GeoPlan) -> bytes:
    """The table of the plan's one route. Raises MissionTextError for none with a pad."""
    (route,) = plan.routes
    if route.home is None:
        raise MissionTextError(
            f"{plan.name}: Litchi's heights are above take-off, which waypoints alone do not have. "
            "Export them as CSV or KML."
        )
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_HEADER)
    for stop in route.stops:
        lat, lon, alt = stop.at
        first = (_TAKE_PHOTO, 0) if stop.photo else (_NOTHING, 0)
        writer.writerow(
            (
                f"{lat:.9f}",
                f"{lon:.9f}",
                f"{alt - route.home[2]:.3f}",
                f"{stop.yaw_deg:.6f}",
                *(0, 0, _GIMBAL_ANGLE, f"{stop.pitch_deg:.6f}"),
                *first,
                *(_NOTHING, 0) * (_ACTIONS - 1),
                *(_ABOVE_TAKE_OFF, f"{route.speed_mps:g}", 0, 0, 0, 0, -1, -1),
            )
        )
    return text.getvalue().encode()
