"""The ground of a scenario."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from jfto.planning.area import area_of, window, with_area
from jfto.planning.scenario_file import UNKNOWN_TERRAIN, LoadedScenario, names_a_file
from jfto_msgs_py.errors import TerrainError

if TYPE_CHECKING:
    from jfto_world.terrain import Dem


def load_ground(loaded: LoadedScenario) -> Dem:
    """Ground and area of a scenario; raises TerrainError, and SiteError of its polygons."""
    # Loaded here: most nodes never read a raster, and one that died must soon be back.
    from jfto_world.terrain import DeclaredHeights, load_dem
    from jfto_world.terrain.load import open_layers

    terrain = loaded.scenario.terrain
    source: str | Path = terrain.source
    if source == UNKNOWN_TERRAIN:
        raise TerrainError(
            f"{loaded.path}: terrain.source is {UNKNOWN_TERRAIN}: plans can be flown so, not made. "
            "Name an elevation model."
        )
    if names_a_file(terrain.source):
        source = loaded.resolve(terrain.source)
    declared = DeclaredHeights(terrain.vertical_unit, terrain.vertical_datum)
    center = (terrain.center_deg[0], terrain.center_deg[1]) if terrain.center_deg else None
    area = area_of(loaded)
    try:
        if area is not None:
            center, size_m = window(area, loaded, open_layers(source, declared))
        else:
            size_m = (terrain.size_m[0], terrain.size_m[1])
        dem = load_dem(
            source,
            center=center,
            size_m=size_m,
            zero_is_void=terrain.zero_is_void,
            declared=declared,
        )
        return dem if area is None else with_area(dem, area)
    except TerrainError as error:
        raise TerrainError(f"{loaded.path}: terrain: {error}") from None


def known_ground(loaded: LoadedScenario) -> Dem | None:
    """Elevation model of a scenario, None where its terrain is unknown; raises TerrainError."""
    unknown = loaded.scenario.terrain.source == UNKNOWN_TERRAIN
    return None if unknown else load_ground(loaded)
