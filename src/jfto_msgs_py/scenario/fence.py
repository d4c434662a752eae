"""Where the fleet must not fly, and what it must not leave."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param

FENCE_HEIGHTS = ("sea_level", "ground")


@dataclass(frozen=True)
class FencePart:
    """No-fly zones, obstacles and the geofence."""

    file: str = param(
        "",
        "Polygons not to be entered: KML, KMZ, GeoJSON, Shapefile, GeoPackage, or the fence of a "
        "QGroundControl .plan file, relative to the scenario file. Properties kind (keep_out or "
        "keep_in), bottom_m, top_m and, of points, radius_m are taken.",
        later=True,
    )
    layer: str = param("", "Layer of fence.file. Left out: the only one with polygons.", later=True)
    keep_out: tuple[str, ...] = param(
        (),
        'No-fly zones and obstacles, a text each: "circle LAT LON RADIUS m" or "polygon LAT LON '
        'LAT LON LAT LON …", then perhaps "bottom METRES", "top METRES", "name WORDS".',
        later=True,
    )
    keep_in: tuple[str, ...] = param(
        (),
        "What the fleet must stay inside of, all of them; texts like fence.keep_out.",
        later=True,
    )
    margin_m: float = param(
        5.0,
        "What routes and curves keep from zones and from the edge of fence.keep_in, sideways and "
        "above and below.",
        unit="m",
        low=0.0,
        high=1000.0,
        later=True,
    )
    heights: str = param(
        "sea_level",
        "What bottom and top of zones are metres above: sea level, or the ground, of which the "
        "highest place under a zone counts for its top and the lowest for its bottom.",
        choices=FENCE_HEIGHTS, later=True,
    )  # fmt: skip
