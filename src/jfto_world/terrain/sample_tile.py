"""The built-in terrain: a real USGS tile that comes with matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np
from affine import Affine
from numpy.typing import NDArray
from pyproj import CRS

from jfto_msgs_py.errors import TerrainError
from jfto_world.terrain.raster import Raster

JACKSBORO = "jacksboro"
_FILE = "jacksboro_fault_dem.npz"


def jacksboro() -> Raster:
    """Pine Mountain and the Jacksboro fault, Tennessee: 3 arc-seconds, 236 to 1076 m.

    The file's `ymin` and `ymax` are swapped: row 0 is its northern edge, as the 1076 m summit of
    the Cumberland Mountains in the south of the tile shows. Both are taken as a pair here.
    """
    # Here, since drawing is no business of a node that needs no more than its own scenario.
    from matplotlib import cbook

    try:
        archive: Any = cbook.get_sample_data(_FILE)  # typed as a stream, is an npz archive
        with archive as tile:
            heights = np.asarray(tile["elevation"], dtype=np.float64)
            west, cell_x, cell_y = (float(tile[key]) for key in ("xmin", "dx", "dy"))
            north = max(float(tile["ymin"]), float(tile["ymax"]))
    except (OSError, KeyError, ValueError) as error:
        raise TerrainError(
            f"The built-in terrain {JACKSBORO!r} cannot be read from matplotlib's sample data "
            f"({error}). Reinstall matplotlib with its sample data, or name a DEM file."
        ) from error

    def read(
        row_start: int, row_stop: int, column_start: int, column_stop: int
    ) -> NDArray[np.float64]:
        return heights[row_start:row_stop, column_start:column_stop].copy()

    return Raster(
        name=JACKSBORO,
        shape=(heights.shape[0], heights.shape[1]),
        transform=Affine(cell_x, 0.0, west, 0.0, -cell_y, north),
        crs=CRS.from_epsg(4326),
        height_datum="mean sea level",
        above_ellipsoid=False,
        read=read,
    )
