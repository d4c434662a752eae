"""From geometries in degrees to rings that can be trusted: nothing is repaired in silence."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from jfto_msgs_py.errors import SiteError
from jfto_world.site.site_file import GeoPolygon, Ring

_SPOT = re.compile(r"\[(\S+) (\S+)\]")
_FAULTS = {
    "Self-intersection": "its outline crosses itself",
    "Ring Self-intersection": "its outline touches or crosses itself",
    "Hole lies outside shell": "a hole of it lies outside of it",
    "Holes are nested": "one of its holes lies in another",
    "Interior is disconnected": "its holes cut it in two",
    "Nested shells": "one of its parts lies in another",
    "Duplicate Rings": "it has the same ring twice",
    "Too few points in geometry component": "it has fewer than 3 different corners",
}
_CURE = "Mend it where it was drawn (QGIS: Check validity, Fix geometries)."


def geo_polygons(geometry: BaseGeometry, place: str) -> tuple[GeoPolygon, ...]:
    """Polygons of a polygon or several, longitude before latitude in degrees; heights are left.

    Raises SiteError for coordinates that are none on Earth, and for rings that cross themselves or
    one another, with the spot.
    """
    flat = shapely.remove_repeated_points(shapely.force_2d(geometry))
    _check_on_earth(shapely.get_coordinates(flat), place)
    if not shapely.is_valid(flat):
        raise SiteError(f"{place}: {_fault(flat)}. {_CURE}")
    return tuple(
        GeoPolygon(_ring(part.exterior.coords), tuple(_ring(h.coords) for h in part.interiors))
        for part in shapely.get_parts(flat)
        if not part.is_empty
    )


def ring_polygon(corners_deg: Ring, place: str) -> tuple[GeoPolygon, ...]:
    """The polygon of one ring, checked like those of files.

    Parameters
    ----------
    corners_deg
        Latitude and longitude of each corner.
    place
        What messages call it.

    Returns
    -------
    tuple of GeoPolygon
        One.

    Raises
    ------
    SiteError
        The ring crosses itself, or has fewer than 3 corners.
    """
    different = set(corners_deg)
    if len(different) < 3:
        raise SiteError(
            f"{place}: has {len(different)} different corner{'s' * (len(different) != 1)}, an area "
            "needs 3 or more. Give them as latitude and longitude in turn."
        )
    return geo_polygons(Polygon([(lon, lat) for lat, lon in corners_deg]), place)


def _ring(coordinates: Iterable[tuple[float, ...]]) -> Ring:
    corners = [(float(lat), float(lon)) for lon, lat, *_ in coordinates]
    return tuple(corners[:-1])


def _check_on_earth(lon_lat: np.ndarray, place: str) -> None:
    if not np.isfinite(lon_lat).all():
        raise SiteError(
            f"{place}: has a corner that is no place on Earth, or beyond the reach of its "
            "coordinate system. Check which one the file is in."
        )
    high_lon, high_lat = np.abs(lon_lat).max(axis=0, initial=0.0)
    if high_lon <= 180 and high_lat <= 90:
        return
    lon, lat = lon_lat[
        int(np.argmax(np.maximum(np.abs(lon_lat[:, 0]) - 180, np.abs(lon_lat[:, 1]) - 90)))
    ]
    if high_lon <= 90 and high_lat <= 180:
        reason = "latitude and longitude are exchanged: exchange them"
    else:
        reason = (
            "these look like metres, and the file names no coordinate system for them: name it "
            "(ogr2ogr -a_srs EPSG:…), or reproject (ogr2ogr -t_srs EPSG:4326)"
        )
    raise SiteError(
        f"{place}: longitude {lon:.10g}, latitude {lat:.10g} is not on Earth; {reason}."
    )


def _fault(geometry: BaseGeometry) -> str:
    reason = str(shapely.is_valid_reason(geometry))
    what = reason.partition("[")[0].strip()
    text = _FAULTS.get(what, what.lower())
    spot = _SPOT.search(reason)
    if spot is None:
        return text
    return f"{text} near {float(spot[2]):.6f}, {float(spot[1]):.6f} (latitude, longitude)"
