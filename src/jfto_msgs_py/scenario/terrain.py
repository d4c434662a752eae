"""The ground."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.scenario.key import param


@dataclass(frozen=True)
class TerrainPart:
    """Elevation model and the rectangle of it that is to be photographed."""

    source: str = param(
        "jacksboro",
        "Elevation model: a GeoTIFF, SRTM .hgt or Esri ASCII file, relative to the scenario "
        'file; "jacksboro", the built-in USGS tile; or "unknown", where a plan is flown of which '
        "no more is known.",
    )
    center_deg: tuple[float, ...] = param(
        (),
        "Latitude and longitude of the middle of the area, WGS-84. Left out: middle of the tile.",
        unit="deg",
        low=-180.0,
        high=180.0,
        length=2,
    )
    size_m: tuple[float, ...] = param(
        (2000.0, 2000.0),
        "Extent of the area, east-west and north-south.",
        unit="m",
        low=20.0,
        high=50_000.0,
        length=2,
    )
    zero_is_void: bool = param(
        True, "Take heights of exactly 0 for missing data, as many files do. Off at the sea."
    )
