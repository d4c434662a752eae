"""The ground as a camera sees it: without what is small against its footprint."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from jfto_world.terrain import CubicSurface, Dem


def smooth_surface(dem: Dem, sigma_m: float) -> CubicSurface:
    """Bicubic surface of the ground after a Gaussian filter of standard deviation `sigma_m`."""
    x, y, z = dem.grid()
    step_x, step_y = float(x[1] - x[0]), float(y[1] - y[0])
    # Reflected oddly, a slope goes on beyond the edge instead of levelling out.
    reach = int(np.ceil(4 * sigma_m / min(step_x, step_y))) + 1
    padded = np.pad(z, reach, mode="reflect", reflect_type="odd")
    smooth = ndimage.gaussian_filter(padded, (sigma_m / step_y, sigma_m / step_x))
    inner = smooth[reach:-reach, reach:-reach]
    return CubicSurface.through(inner, float(x[0]), float(y[0]), step_x, step_y)
