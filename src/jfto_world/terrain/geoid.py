"""The geoid: how far mean sea level lies above the ellipsoid of WGS-84.

PROJ's own grid of EGM96 is used where it is installed, else a table of 30 arc-minutes that comes
with the package: every second node of each row and column of NGA's WW15MGH.GRD (EGM96, a work of
the United States government in the public domain), rounded to 0.1 m. Interpolated bicubically it
is within 0.95 m of every node of that grid, and within 0.05 m in the root mean square.
"""

from __future__ import annotations

from functools import lru_cache
from importlib import resources

import numpy as np
import rasterio
from numpy.typing import ArrayLike
from pyproj import Transformer
from pyproj.exceptions import ProjError

from jfto_msgs_py.types import Array
from jfto_world.terrain.cubic_surface import CubicSurface

TABLE_ACCURACY_M = 1.0
_TABLE = "egm96_30min.tif"
_STEP_DEG = 0.5
# Nodes beyond the poles and across the meridian, so that the spline knows no edge there.
_OVERLAP = 12
# Names of the grid in PROJ's data since version 7 and before.
_PROJ_GRIDS = ("us_nga_egm96_15.tif", "egm96_15.gtx")


def geoid_height(lat_deg: ArrayLike, lon_deg: ArrayLike) -> Array:
    """Height of the EGM96 geoid above the ellipsoid, m, at points of any one shape in degrees.

    Longitudes may be of any turn. A height above sea level is that above the ellipsoid less this.
    """
    lat, lon = np.broadcast_arrays(*(np.asarray(v, dtype=np.float64) for v in (lat_deg, lon_deg)))
    grid = _proj_grid()
    if grid is not None:
        around = (lon + 180.0) % 360.0 - 180.0
        return np.asarray(grid[1].transform(around, lat, np.zeros(lat.shape))[2])
    return _table().height_and_gradient(lon % 360.0, lat)[0]


def geoid_name() -> str:
    """Which geoid `geoid_height` gives, and how well, for plans and reports."""
    grid = _proj_grid()
    if grid is not None:
        return f"EGM96 (PROJ's {grid[0]})"
    return f"EGM96 (built-in table of 30', within {TABLE_ACCURACY_M:.0f} m)"


@lru_cache(maxsize=1)
def _proj_grid() -> tuple[str, Transformer] | None:
    for name in _PROJ_GRIDS:
        try:
            found = Transformer.from_pipeline(
                "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad "
                f"+step +proj=vgridshift +grids={name} +multiplier=1 "
                "+step +proj=unitconvert +xy_in=rad +xy_out=deg"
            )
        except ProjError:
            continue
        return name, found
    return None


@lru_cache(maxsize=1)
def _table() -> CubicSurface:
    content = (resources.files("jfto_world.terrain") / "data" / _TABLE).read_bytes()
    with rasterio.MemoryFile(content) as file, file.open() as dataset:
        metres = dataset.read(1) * dataset.scales[0]
    # Over a pole the meridian goes on as the one opposite.
    opposite = np.roll(metres, metres.shape[1] // 2, axis=1)
    above, below = opposite[_OVERLAP:0:-1], opposite[-2 : -2 - _OVERLAP : -1]
    whole = np.pad(np.vstack([above, metres, below]), ((0, 0), (_OVERLAP,) * 2), mode="wrap")
    north, west = 90.0 + _OVERLAP * _STEP_DEG, -_OVERLAP * _STEP_DEG
    return CubicSurface.through(whole, west, north, _STEP_DEG, -_STEP_DEG)
