"""The polygons that a scenario wants photographed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from jfto.planning.scenario_file import LoadedScenario
from jfto_msgs_py.errors import SiteError

if TYPE_CHECKING:
    from jfto_world.site import SiteArea
    from jfto_world.terrain import Dem
    from jfto_world.terrain.layer import Layer


def area_of(loaded: LoadedScenario) -> SiteArea | None:
    """Area of a scenario's `area` keys, None where it is the rectangle. Raises SiteError."""
    wanted = loaded.scenario.area
    if not wanted.file and not wanted.polygon_deg:
        return None
    from jfto_world.site import SiteArea, polygon_area, read_site

    try:
        if wanted.polygon_deg:
            return polygon_area(wanted.polygon_deg, wanted.buffer_m)
        path = loaded.resolve(wanted.file)
        found = read_site(path, wanted.layer)
        polygons = tuple(polygon for shape in found.shapes for polygon in shape.polygons)
        if not polygons:
            raise SiteError(
                f"area.file: {path}: has no polygon, but {len(found.points)} points. Draw the area "
                "as a polygon."
            )
    except SiteError as error:
        raise SiteError(f"{loaded.path}: {error}") from None
    return SiteArea(f"area.file {path}", polygons, wanted.buffer_m, found.notes)


def window(
    area: SiteArea, loaded: LoadedScenario, layers: Sequence[Layer]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Centre (latitude, longitude) and size in metres of the ground that an area needs.

    terrain.center_deg and terrain.size_m win where they are given. Raises SiteError where the area
    does not lie on the terrain, or not within terrain.size_m.
    """
    terrain = loaded.scenario.terrain
    try:
        area.require_on(layers)
        given = terrain.center_deg
        center = (given[0], given[1]) if given else area.middle_deg
        needed = area.window_m(center)
        if not terrain.size_m:
            return center, needed
        size = (terrain.size_m[0], terrain.size_m[1])
        if any(want > have * 1.002 for want, have in zip(needed, size, strict=True)):
            raise SiteError(
                f"{area.source}: needs {math.ceil(needed[0])} m × {math.ceil(needed[1])} m about "
                f"{center[0]:.5f}, {center[1]:.5f}, but terrain.size_m is {size[0]:g} m × "
                f"{size[1]:g} m. Leave out terrain.size_m (and terrain.center_deg), or enlarge it."
            )
    except SiteError as error:
        raise SiteError(f"{loaded.path}: {error}") from None
    return center, size


def with_area(dem: Dem, area: SiteArea) -> Dem:
    """Ground whose area is the polygons, in its very frame. Raises SiteError."""
    return replace(dem, area=area.local(dem.frame))
