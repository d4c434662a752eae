"""The ground of a scenario, and what stands on it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from jfto.planning.area import area_of, window, with_area
from jfto.planning.scenario_file import UNKNOWN_TERRAIN, LoadedScenario, names_a_file
from jfto_msgs_py.errors import TerrainError

if TYPE_CHECKING:
    from jfto_world.terrain import DeclaredHeights, Dem
    from jfto_world.terrain.layer import Layer


def load_ground(loaded: LoadedScenario) -> Dem:
    """Ground and area of a scenario, and what stands on it if there is a surface model.

    Raises TerrainError, and SiteError of the area's polygons.
    """
    # Loaded here: most nodes never read a raster, and one that died must soon be back.
    from jfto_world.terrain import load_surface

    terrain = loaded.scenario.terrain
    if terrain.source == UNKNOWN_TERRAIN:
        raise TerrainError(
            f"{loaded.path}: terrain.source is {UNKNOWN_TERRAIN}: plans can be flown so, not made. "
            "Name an elevation model."
        )
    area = area_of(loaded)
    if area is None:
        center = (terrain.center_deg[0], terrain.center_deg[1]) if terrain.center_deg else None
        size_m = (terrain.size_m[0], terrain.size_m[1])
    else:
        center, size_m = window(area, loaded, _layers(loaded))
    if terrain.surface:
        dem = load_surface(
            lambda margin_m: _load(loaded, "source", center, size_m, margin_m),
            lambda centre, margin_m: _load(loaded, "surface", centre, size_m, margin_m),
            f"{loaded.path}: terrain.surface: {terrain.surface}",
        )
    else:
        dem = _load(loaded, "source", center, size_m, None)
    return dem if area is None else with_area(dem, area)


def known_ground(loaded: LoadedScenario) -> Dem | None:
    """Elevation model of a scenario, None where its terrain is unknown; raises TerrainError."""
    unknown = loaded.scenario.terrain.source == UNKNOWN_TERRAIN
    return None if unknown else load_ground(loaded)


def terrain_files(loaded: LoadedScenario) -> list[Path]:
    """Files that a scenario's ground is made of, also those of folders and mosaics."""
    found: list[Path] = []
    for named in (loaded.scenario.terrain.source, loaded.scenario.terrain.surface):
        path = loaded.resolve(named) if named and names_a_file(named) else None
        if path is None:
            continue
        found.extend(sorted(p for p in path.iterdir() if p.is_file()) if path.is_dir() else [path])
        if path.suffix.lower() == ".vrt" and path.is_file():
            from jfto_world.terrain.mosaic_file import mosaic_files

            found.extend(mosaic_files(path))
    return found


def _layers(loaded: LoadedScenario) -> Sequence[Layer]:
    from jfto_world.terrain.load import open_layers

    try:
        return open_layers(_source(loaded, "source"), _declared(loaded))
    except TerrainError as error:
        raise TerrainError(f"{loaded.path}: terrain.source: {error}") from None


def _load(
    loaded: LoadedScenario,
    key: str,
    center: tuple[float, float] | None,
    size_m: tuple[float, float],
    margin_m: float | None,
) -> Dem:
    from jfto_world.terrain import load_dem

    try:
        return load_dem(
            _source(loaded, key),
            center=center,
            size_m=size_m,
            margin_m=margin_m,
            zero_is_void=loaded.scenario.terrain.zero_is_void,
            declared=_declared(loaded),
        )
    except TerrainError as error:
        raise TerrainError(f"{loaded.path}: terrain.{key}: {error}") from None


def _source(loaded: LoadedScenario, key: str) -> str | Path:
    named: str = getattr(loaded.scenario.terrain, key)
    return loaded.resolve(named) if names_a_file(named) else named


def _declared(loaded: LoadedScenario) -> DeclaredHeights:
    from jfto_world.terrain import DeclaredHeights

    terrain = loaded.scenario.terrain
    return DeclaredHeights(terrain.vertical_unit, terrain.vertical_datum)
