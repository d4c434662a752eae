"""From a raster anywhere on earth to the ground of one scenario."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from affine import Affine
from numpy.typing import NDArray
from scipy import ndimage

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.records.plan import Origin
from jfto_msgs_py.types import Array
from jfto_world.terrain.cubic_surface import CubicSurface
from jfto_world.terrain.dem import Dem
from jfto_world.terrain.frame import LocalFrame
from jfto_world.terrain.height_reference import DeclaredHeights
from jfto_world.terrain.raster import Raster, apply_affine
from jfto_world.terrain.raster_file import AS_IN_FILE, open_raster
from jfto_world.terrain.sample_tile import JACKSBORO, jacksboro
from jfto_world.terrain.tiles import open_tiles

DEFAULT_MARGIN_M = 500.0
# Shares of the default margin that are tried where a raster ends near the area.
_MARGIN_SHARES = (1.0, 0.7, 0.5, 0.3, 0.2, 0.1, 0.0)
# The Dead Sea's shore and Everest, with some room for mines and for noise.
LOWEST_M, HIGHEST_M = -600.0, 9000.0
_LARGEST_M = 100_000.0
# Three nodes per source cell keep the second interpolation within centimetres of the first.
_NODES_PER_CELL = 3
_MOST_NODES = 1000
_STRIP_CELLS = 4_000_000


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

    The origin's altitude is the ground's at the centre, in the file's own height datum.

    Parameters
    ----------
    source
        A GeoTIFF, SRTM .hgt, Esri ASCII file or other raster in any CRS, a folder of neighbouring
        tiles, or "jacksboro" for the built-in tile.
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
    raster = _raster(source, declared)
    lat_deg, lon_deg = _check_center(raster, center)
    _check_size(size_m, margin_m)
    frame = LocalFrame(Origin(lat_deg, lon_deg, 0.0))
    cell_m = _cell_size(raster, frame)
    half, x, y, columns, rows = _cut(raster, frame, size_m, margin_m, cell_m)
    grid_x, grid_y = np.meshgrid(x, y)
    block = max(1, round(min(x[1] - x[0], y[1] - y[0]) / cell_m))
    ground, affine = _source_surface(raster, columns, rows, block, zero_is_void)

    origin = _origin(raster, ground, affine, lat_deg, lon_deg)
    frame = LocalFrame(origin)
    z = np.zeros_like(grid_x)
    # Where a vertical line meets the ground depends on height by x z / R: two rounds settle it.
    for _ in range(3):
        lat, lon, _ = frame.to_geodetic(np.stack([grid_x, grid_y, z], axis=-1))
        altitude = _sample(ground, affine, *raster.cells(lat, lon))
        z = frame.to_enu(lat, lon, altitude)[..., 2]
    return Dem(
        origin=origin,
        size_m=(float(size_m[0]), float(size_m[1])),
        half_extent_m=half,
        surface=CubicSurface.through(z, x[0], y[0], x[1] - x[0], y[1] - y[0]),
        height_datum=raster.height_datum,
        above_ellipsoid=raster.above_ellipsoid,
        description=(
            f"{raster.name}: {raster.crs.name}, cells of {cell_m * block:.3g} m, "
            f"heights above {raster.height_datum}, origin at {origin.alt_m:.1f} m, "
            f"known {half[0] - size_m[0] / 2:.0f} m beyond the area"
            + (f", {raster.placing.note}" if raster.placing.note else "")
        ),
    )


def _raster(source: str | Path, declared: DeclaredHeights) -> Raster:
    if str(source) == JACKSBORO:
        if declared != AS_IN_FILE:
            raise TerrainError(
                f"{JACKSBORO}: its heights are metres above mean sea level. Leave out "
                "terrain.vertical_unit and terrain.vertical_datum."
            )
        return jacksboro()
    path = Path(source)
    return open_tiles(path, declared) if path.is_dir() else open_raster(path, declared)


def _check_center(raster: Raster, center: tuple[float, float] | None) -> tuple[float, float]:
    if center is None:
        rows, columns = raster.shape
        lat, lon = raster.geodetic(np.array((columns - 1) / 2), np.array((rows - 1) / 2))
        return float(lat), float(lon)
    lat_deg, lon_deg = float(center[0]), float(center[1])
    if not (-90 < lat_deg < 90 and -180 <= lon_deg <= 180):
        raise TerrainError(
            f"{raster.name}: centre ({lat_deg}, {lon_deg}) is not a latitude and longitude in "
            "degrees. Give latitude first."
        )
    return lat_deg, lon_deg


def _check_size(size_m: tuple[float, float], margin_m: float | None) -> None:
    if not all(0 < side <= _LARGEST_M for side in size_m):
        raise TerrainError(
            f"size_m is {tuple(size_m)}, both sides must be positive and at most 100 km."
        )
    if margin_m is not None and not 0 <= margin_m <= _LARGEST_M:
        raise TerrainError(f"margin_m is {margin_m}, must be between 0 and 100 km.")


def _cell_size(raster: Raster, frame: LocalFrame) -> float:
    """The shorter side of a raster cell, in metres, at the frame's origin."""
    origin = frame.origin
    column, row = raster.cells(np.array(origin.lat_deg), np.array(origin.lon_deg))
    if not (np.isfinite(column) and np.isfinite(row)):
        raise TerrainError(
            f"{raster.name}: centre ({origin.lat_deg}, {origin.lon_deg}) lies outside the reach "
            f"of its coordinate system. It covers {raster.extent_text()}."
        )
    lat, lon = raster.geodetic(column + np.array([0.0, 1.0, 0.0]), row + np.array([0.0, 0.0, 1.0]))
    corner = frame.to_enu(lat, lon, 0.0)
    return float(min(np.linalg.norm(corner[1] - corner[0]), np.linalg.norm(corner[2] - corner[0])))


def _axes(half: tuple[float, float], cell_m: float) -> tuple[Array, Array]:
    """Node coordinates, an odd number per axis so that one lies on the origin."""

    def axis(half_side: float) -> Array:
        spacing = max(cell_m / _NODES_PER_CELL, 2 * max(half) / _MOST_NODES)
        steps = max(2, math.ceil(half_side / spacing))
        return np.linspace(-half_side, half_side, 2 * steps + 1)

    return axis(half[0]), axis(half[1])


def _cut(
    raster: Raster,
    frame: LocalFrame,
    size_m: tuple[float, float],
    margin_m: float | None,
    cell_m: float,
) -> tuple[tuple[float, float], Array, Array, Array, Array]:
    """Half extent, node axes x and y, and the raster's columns and rows under the nodes.

    Takes the widest margin that the raster covers; raises TerrainError where it covers none.
    """
    height, width = raster.shape
    wide = DEFAULT_MARGIN_M
    margins = [margin_m] if margin_m is not None else [share * wide for share in _MARGIN_SHARES]
    for margin in margins:
        half = (size_m[0] / 2 + margin, size_m[1] / 2 + margin)
        x, y = _axes(half, cell_m)
        nodes = np.stack([*np.meshgrid(x, y), np.zeros((len(y), len(x)))], axis=-1)
        lat, lon, _ = frame.to_geodetic(nodes)
        columns, rows = raster.cells(lat, lon)
        inside = (columns >= 0) & (columns <= width - 1) & (rows >= 0) & (rows <= height - 1)
        if inside.all():
            return half, x, y, columns, rows
    share = 100 * float(np.mean(inside))
    beyond = f" with its margin of {margin_m:.0f} m" if margin_m else ""
    cure = "size_m or margin_m" if margin_m else "size_m"
    raise TerrainError(
        f"{raster.name} covers only {share:.0f} % of the area{beyond}: it holds "
        f"{raster.extent_text()}. Move the centre, make {cure} smaller, or merge it with its "
        "neighbours (gdal_merge.py)."
    )


def _source_surface(
    raster: Raster, columns: Array, rows: Array, block: int, zero_is_void: bool
) -> tuple[CubicSurface, Affine]:
    """Surface in (blocked) cell coordinates, and the map from raster cells to them."""
    height, width = raster.shape
    margin = 3 * block
    row_start = max(0, math.floor(rows.min()) - margin)
    row_stop = min(height, math.ceil(rows.max()) + margin + 1)
    column_start = max(0, math.floor(columns.min()) - margin)
    column_stop = min(width, math.ceil(columns.max()) + margin + 1)
    heights = _read_blocks(
        raster, (row_start, row_stop, column_start, column_stop), block, zero_is_void
    )
    half = (block - 1) / 2
    to_blocks = Affine(
        1 / block, 0.0, -(column_start + half) / block, 0.0, 1 / block, -(row_start + half) / block
    )
    used = np.zeros(heights.shape, dtype=bool)
    u, v = apply_affine(to_blocks, columns, rows)
    used[
        np.clip(np.rint(v).astype(int), 0, heights.shape[0] - 1),
        np.clip(np.rint(u).astype(int), 0, heights.shape[1] - 1),
    ] = True
    used = ndimage.binary_dilation(used, np.ones((3, 3), dtype=bool))
    _check_heights(raster, heights, used, ~to_blocks, zero_is_void)
    void = np.isnan(heights)
    if void.any():
        # Outside the area only: a neutral value that does not bend the spline inside it.
        nearest = ndimage.distance_transform_edt(void, return_distances=False, return_indices=True)
        heights = heights[tuple(nearest)]
    return CubicSurface.through(heights, 0.0, 0.0, 1.0, 1.0), to_blocks


def _read_blocks(
    raster: Raster, window: tuple[int, int, int, int], block: int, zero_is_void: bool
) -> Array:
    """Heights of a window, averaged over block × block cells; one missing voids its block."""
    row_start, row_stop, column_start, column_stop = window
    width = column_stop - column_start
    columns = max(1, width // block)
    strips = []
    rows_at_once = max(1, _STRIP_CELLS // (width * block)) * block
    for row in range(row_start, row_stop, rows_at_once):
        strip = raster.read(row, min(row + rows_at_once, row_stop), column_start, column_stop)
        if zero_is_void:
            strip[strip == 0] = np.nan
        strip[np.isinf(strip)] = np.nan
        rows = len(strip) // block
        trimmed = strip[: rows * block, : columns * block]
        strips.append(trimmed.reshape(rows, block, columns, block).mean(axis=(1, 3)))
    return np.concatenate(strips)


def _check_heights(
    raster: Raster, heights: Array, used: NDArray[np.bool_], to_cells: Affine, zero_is_void: bool
) -> None:
    def place(fault: NDArray[np.bool_]) -> str:
        row, column = np.argwhere(fault)[0]
        lat, lon = raster.geodetic(*apply_affine(to_cells, column, row))
        return f"first at {float(lat):.5f}, {float(lon):.5f}"

    void = np.isnan(heights) & used
    if void.any():
        zero = "Heights of 0 m count as missing; set zero_is_void to false where they are sea. "
        raise TerrainError(
            f"{raster.name} has {int(void.sum())} of {int(used.sum())} cells without a height in "
            f"the area or its margin, {place(void)}. {zero if zero_is_void else ''}"
            "Move the centre, shrink the margin, or fill the gaps (gdal_fillnodata.py)."
        )
    absurd = used & ((heights < LOWEST_M) | (heights > HIGHEST_M))
    if absurd.any():
        row, column = np.argwhere(absurd)[0]
        raise TerrainError(
            f"{raster.name} has heights no ground on earth has, {heights[row, column]:g} m, "
            f"{place(absurd)}. If this value marks missing data, declare it "
            "(gdal_edit.py -a_nodata); if heights are in other units, convert them to metres."
        )


def _sample(ground: CubicSurface, affine: Affine, columns: Array, rows: Array) -> Array:
    u, v = apply_affine(affine, columns, rows)
    return ground.height_and_gradient(u, v)[0]


def _origin(
    raster: Raster, ground: CubicSurface, affine: Affine, lat_deg: float, lon_deg: float
) -> Origin:
    column, row = raster.cells(np.array([lat_deg]), np.array([lon_deg]))
    return Origin(lat_deg, lon_deg, float(_sample(ground, affine, column, row)[0]))
