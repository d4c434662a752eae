"""What a file of areas holds, in degrees, before it is brought into a local frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

# Latitude and longitude of each corner in degrees (WGS-84), without the closing corner.
Ring = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class GeoPolygon:
    """A polygon on the map: its outer ring and its holes, which do not cross one another."""

    outer_deg: Ring
    holes_deg: tuple[Ring, ...] = ()


@dataclass(frozen=True)
class SiteShape:
    """One feature of a file: polygons, or a point where `polygons` is empty.

    `place` names file, feature and name, for messages; `properties` are the feature's own, as the
    file has them (numbers may be text, as in KML).
    """

    place: str
    name: str
    polygons: tuple[GeoPolygon, ...]
    point_deg: tuple[float, float] | None = None
    properties: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class SiteFile:
    """Features of a file in its order, and `notes` on what is not taken as it stands, a line each.

    `points` may stand for the middles of circles; who wants areas leaves them.
    """

    shapes: tuple[SiteShape, ...]
    points: tuple[SiteShape, ...] = ()
    notes: tuple[str, ...] = ()
