"""From elevation models anywhere on earth to the ground of one scenario."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.records.plan import Origin
from jfto_world.terrain.area_grid import (
    DEFAULT_MARGIN_M,
    AreaGrid,
    area_grid,
    check_center,
    check_size,
    layers_under,
)
from jfto_world.terrain.autopilot_grid import open_autopilot_grids
from jfto_world.terrain.cubic_surface import CubicSurface
from jfto_world.terrain.dem import Dem
from jfto_world.terrain.frame import LocalFrame
from jfto_world.terrain.height_reference import DeclaredHeights
from jfto_world.terrain.layer import Heights, Layer
from jfto_world.terrain.packed import kind_of
from jfto_world.terrain.raster_file import AS_IN_FILE, AUTOPILOT, SUFFIXES, open_raster
from jfto_world.terrain.raster_layer import RasterLayer
from jfto_world.terrain.sample_tile import JACKSBORO, jacksboro
from jfto_world.terrain.sea_level import altitudes_under, datum_of
from jfto_world.terrain.tiles import open_tiles

__all__ = ["DEFAULT_MARGIN_M", "DeclaredHeights", "load_dem", "open_layers"]


def load_dem(
    source: str | Path,
    *,
    center: tuple[float, float] | None,
    size_m: tuple[float, float],
    margin_m: float | None = None,
    zero_is_void: bool = True,
    declared: DeclaredHeights = AS_IN_FILE,
) -> Dem:
    """Ground of an area, known some way beyond it too, as cameras stand outside of slopes.

    Heights above the ellipsoid are brought to sea level by the geoid.

    Parameters
    ----------
    source
        A GeoTIFF, SRTM .hgt, Esri ASCII file or other raster in any CRS, ArduPilot's .DAT, a
        folder of tiles, or "jacksboro" for the built-in tile.
    center
        Latitude and longitude, degrees; None: the middle of the raster.
    size_m
        East-west and north-south.
    margin_m
        How far beyond; None: 500 m, or as much of that as the raster holds.
    zero_is_void
        Heights of exactly 0 are missing data, as in many files; switch it off at the sea.
    declared
        What a file leaves open of its heights.

    Returns
    -------
    Dem
        The ground.

    Raises
    ------
    TerrainError
        Names file, reason and cure.
    """
    every = open_layers(source, declared)
    name = every[0].name if len(every) == 1 else str(source)
    in_folder = Path(source).is_dir()
    lat_deg, lon_deg = every[0].middle() if center is None else check_center(name, center)
    check_size(size_m, margin_m)
    frame = LocalFrame(Origin(lat_deg, lon_deg, 0.0))
    layers = layers_under(every, frame, size_m, margin_m)
    grid = area_grid(layers, frame, size_m, margin_m, name, in_folder=in_folder)
    altitudes, agreement = altitudes_under(
        layers, grid, frame, zero_is_void, name, in_folder=in_folder
    )

    datum, converted = datum_of(layers[0], frame)
    middle = altitudes(np.array([lat_deg]), np.array([lon_deg]))
    origin = Origin(lat_deg, lon_deg, float(middle[0]), datum)
    return Dem(
        origin=origin,
        size_m=(float(size_m[0]), float(size_m[1])),
        half_extent_m=grid.half_m,
        surface=_surface(grid, altitudes, LocalFrame(origin)),
        height_datum=datum,
        description=_description(name, layers, grid, datum, origin, size_m),
        notes=(*_notes(layers), *agreement, *converted),
    )


def open_layers(source: str | Path, declared: DeclaredHeights = AS_IN_FILE) -> tuple[Layer, ...]:
    """Elevation models of a source as `load_dem` takes it, none of their heights read.

    Parameters
    ----------
    source
        As for `load_dem`.
    declared
        What a file leaves open of its heights.

    Returns
    -------
    tuple of Layer
        One or more.

    Raises
    ------
    TerrainError
        Names file, reason and cure.
    """
    path = Path(source)
    own = "" if str(source) == JACKSBORO else "ArduPilot's terrain"
    if own and not path.is_dir() and kind_of(path, SUFFIXES) != AUTOPILOT:
        return (RasterLayer(open_raster(path, declared)),)
    if own and path.is_dir():
        return open_tiles(path, declared)
    if declared != AS_IN_FILE:
        raise TerrainError(
            f"{source}: its heights are metres above mean sea level. Leave out "
            "terrain.vertical_unit and terrain.vertical_datum."
        )
    if own:
        return (open_autopilot_grids([path], str(path)),)
    return (RasterLayer(jacksboro()),)


def _notes(layers: Sequence[Layer]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(note for layer in layers for note in layer.notes))


def _surface(grid: AreaGrid, altitudes: Heights, frame: LocalFrame) -> CubicSurface:
    grid_x, grid_y = np.meshgrid(grid.x, grid.y)
    z = np.zeros_like(grid_x)
    # Where a vertical line meets the ground depends on height by x z / R: two rounds settle it.
    for _ in range(3):
        lat, lon, _ = frame.to_geodetic(np.stack([grid_x, grid_y, z], axis=-1))
        z = frame.to_enu(lat, lon, altitudes(lat, lon))[..., 2]
    x, y = grid.x, grid.y
    return CubicSurface.through(z, x[0], y[0], x[1] - x[0], y[1] - y[0])


def _description(
    name: str,
    layers: Sequence[Layer],
    grid: AreaGrid,
    datum: str,
    origin: Origin,
    size_m: tuple[float, float],
) -> str:
    block = max(1, round(grid.spacing_m / grid.cell_m))
    systems = ", ".join(dict.fromkeys(layer.system for layer in layers))
    placed = dict.fromkeys(layer.placed for layer in layers if layer.placed)
    several = f" in {len(layers)} grids" if len(layers) > 1 else ""
    return ", ".join(
        [
            f"{name}: {systems}{several}",
            f"cells of {grid.cell_m * block:.3g} m",
            f"heights above {datum}",
            f"origin at {origin.alt_m:.1f} m",
            f"known {grid.half_m[0] - size_m[0] / 2:.0f} m beyond the area",
            *placed,
        ]
    )
