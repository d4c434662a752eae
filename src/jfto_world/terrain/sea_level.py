"""Heights of one or several elevation models under an area, above sea level."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array, Flags
from jfto_world.terrain.area_grid import SEAM_CELLS, AreaGrid
from jfto_world.terrain.frame import LocalFrame
from jfto_world.terrain.geoid import geoid_height, geoid_name
from jfto_world.terrain.layer import Heights, Layer
from jfto_world.terrain.overlap import Overlap

# Places move by millimetres as their heights become known, which takes them off the last cell.
_SLACK_CELLS = 0.01


def altitudes_under(
    layers: Sequence[Layer],
    grid: AreaGrid,
    frame: LocalFrame,
    zero_is_void: bool,
    name: str,
    *,
    in_folder: bool = False,
) -> tuple[Heights, tuple[str, ...]]:
    """Altitudes above sea level at the grid's places, and a line on how well layers agree.

    Of several layers the first that has a height is taken: they come finest first. Raises
    TerrainError for places without a height in any, with the cure that a folder of tiles has.
    """
    lat, lon = grid.lat, grid.lon
    parts: list[tuple[Layer, Heights]] = []
    for layer in layers:
        here = layer.covers(lat, lon, SEAM_CELLS)
        if here.any():
            cell_m = layer.cell_m(frame)
            read = layer.heights(lat[here], lon[here], grid.spacing_m, cell_m, zero_is_void)
            parts.append((layer, _at_sea_level(layer, read)))
    altitudes = parts[0][1] if len(parts) == 1 else _ranked(parts)
    missing = np.isnan(altitudes(lat, lon))
    if missing.any():
        zero = zero_is_void and _zeros_there(layers, grid, frame, missing)
        raise TerrainError(_gap(missing, grid, name, in_folder=in_folder, zero=zero))
    overlap = Overlap()
    found = [(layer.name, _within(layer, read, 0.0)(lat, lon)) for layer, read in parts[1:]]
    if found:
        finest, read = parts[0]
        first = finest.name, _within(finest, read, 0.0)(lat, lon)
        for other in found:
            overlap.compare(first, other)
    return altitudes, overlap.notes()


def _ranked(parts: Sequence[tuple[Layer, Heights]]) -> Heights:
    """Heights of the first part that has one; beyond its outermost cells it comes after others."""
    ranked = [_within(layer, read, beyond) for beyond in (0.0, SEAM_CELLS) for layer, read in parts]

    def altitudes(lat_deg: Array, lon_deg: Array) -> Array:
        result = np.full(lat_deg.shape, np.nan)
        for heights in ranked:
            missing = np.isnan(result)
            if missing.any():
                result[missing] = heights(lat_deg[missing], lon_deg[missing])
        return result

    return altitudes


def datum_of(layer: Layer, frame: LocalFrame) -> tuple[str, tuple[str, ...]]:
    """What altitudes of a layer are measured from at sea level, and a line if that was changed."""
    if not layer.above_ellipsoid:
        return layer.height_datum, ()
    origin = frame.origin
    geoid_m = float(geoid_height(origin.lat_deg, origin.lon_deg))
    how = f"are brought to sea level by the geoid {geoid_name()}, {geoid_m:+.1f} m at the origin"
    return (
        f"mean sea level by the geoid {geoid_name()}",
        (f"{layer.name}: heights above the {layer.height_datum} {how}",),
    )


def _within(layer: Layer, heights: Heights, beyond: float) -> Heights:
    """Heights, NaN where the layer doesn't reach."""
    slack = beyond + _SLACK_CELLS

    def limited(lat: Array, lon: Array) -> Array:
        return np.where(layer.covers(lat, lon, slack), heights(lat, lon), np.nan)

    return limited


def _at_sea_level(layer: Layer, heights: Heights) -> Heights:
    if not layer.above_ellipsoid:
        return heights
    return lambda lat, lon: heights(lat, lon) - geoid_height(lat, lon)


def _zeros_there(layers: Sequence[Layer], grid: AreaGrid, frame: LocalFrame, gap: Flags) -> bool:
    """Whether any place of a gap has a height once those of exactly 0 count."""
    lat, lon = grid.lat, grid.lon
    for layer in layers:
        here = layer.covers(lat, lon, SEAM_CELLS)
        if (here & gap).any():
            read = layer.heights(lat[here], lon[here], grid.spacing_m, layer.cell_m(frame), False)
            if np.isfinite(read(lat[here & gap], lon[here & gap])).any():
                return True
    return False


def _gap(missing: Flags, grid: AreaGrid, name: str, *, in_folder: bool, zero: bool) -> str:
    """How much is without a height, where that begins, and what to do."""
    row, column = np.argwhere(missing)[0]
    percent = 100 * float(missing.mean())
    share = f"{percent:.0f}" if percent >= 1 else f"{percent:.2g}"
    cure = "Heights of 0 m count as missing; set zero_is_void to false where they are sea. "
    tile = "Add the tile that lies there, move" if in_folder else "Move"
    return (
        f"{name}: {share} % of the area or its margin is without a "
        f"height, first at {float(grid.lat[row, column]):.5f}, "
        f"{float(grid.lon[row, column]):.5f}. {cure if zero else ''}"
        f"{tile} the centre, shrink the margin, or fill the gaps (gdal_fillnodata.py)."
    )
