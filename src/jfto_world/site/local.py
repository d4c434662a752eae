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
    """Each polygon in a local frame, its edges straight there.

    Parameters
    ----------
    polygons
        In degrees, as files have them.
    frame
        Where the local frame sits.

    Returns
    -------
    tuple of Polygon
        ENU metres about the frame's origin, in the same order.
    """

    def ring(corners: RingDeg) -> Ring:
        lat, lon = np.array(corners).T
        places = frame.to_enu(lat, lon, frame.origin.alt_m)
        return tuple((float(x), float(y)) for x, y, _ in places)

    return tuple(
        Polygon(ring(one.outer_deg), tuple(ring(hole) for hole in one.holes_deg))
        for one in polygons
    )


def as_shapely(polygons: Iterable[Polygon]) -> shapely.MultiPolygon:
    """One geometry of shapely, nothing joined.

    Parameters
    ----------
    polygons
        In any frame.

    Returns
    -------
    shapely.MultiPolygon
        The same parts in the same order.
    """
    return shapely.MultiPolygon([(one.outer, one.holes) for one in polygons])


def of_shapely(geometry: shapely.Geometry) -> tuple[Polygon, ...]:
    """Records of a geometry's parts.

    Parameters
    ----------
    geometry
        A polygon or several of shapely.

    Returns
    -------
    tuple of Polygon
        From west to east, none of them empty.
    """

    def ring(line: shapely.LinearRing) -> Ring:
        return tuple((float(x), float(y)) for x, y in line.coords[:-1])

    parts = sorted(
        (part for part in shapely.get_parts(geometry) if not part.is_empty),
        key=lambda part: part.bounds,
    )
    return tuple(Polygon(ring(p.exterior), tuple(map(ring, p.interiors))) for p in parts)
