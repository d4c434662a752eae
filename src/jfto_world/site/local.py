"""Polygons in the local frame of a scenario, and as shapely takes them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import shapely

from jfto_msgs_py.records.site import Polygon, Ring
from jfto_world.site.site_file import GeoPolygon
from jfto_world.site.site_file import Ring as RingDeg
from jfto_world.terrain.frame import LocalFrame


def local_polygons(polygons: Iterable[GeoPolygon], frame: LocalFrame) -> tuple[Polygon, ...]:
    """Each polygon in ENU metres about the frame's origin, its edges straight there."""

    def ring(corners: RingDeg) -> Ring:
        lat, lon = np.array(corners).T
        places = frame.to_enu(lat, lon, frame.origin.alt_m)
        return tuple((float(x), float(y)) for x, y, _ in places)

    return tuple(
        Polygon(ring(one.outer_deg), tuple(ring(hole) for hole in one.holes_deg))
        for one in polygons
    )


def as_shapely(polygons: Iterable[Polygon]) -> shapely.MultiPolygon:
    """The polygons as one geometry of shapely, not joined."""
    return shapely.MultiPolygon([(one.outer, one.holes) for one in polygons])


def of_shapely(geometry: shapely.Geometry) -> tuple[Polygon, ...]:
    """Polygons of a polygon or several, from west to east."""

    def ring(line: shapely.LinearRing) -> Ring:
        return tuple((float(x), float(y)) for x, y in line.coords[:-1])

    parts = sorted(
        (part for part in shapely.get_parts(geometry) if not part.is_empty),
        key=lambda part: part.bounds,
    )
    return tuple(Polygon(ring(p.exterior), tuple(map(ring, p.interiors))) for p in parts)
