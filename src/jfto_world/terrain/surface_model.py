"""What stands on the ground: a surface model (trees, roofs) over a terrain model (bare ground)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array
from jfto_world.terrain.cubic_surface import CubicSurface
from jfto_world.terrain.dem import Dem

# Medians of a surface above its ground that no land on earth has: two places, units or datums.
_LOWEST_M, _HIGHEST_M = -5.0, 60.0
# Noise of two models of the same bare ground, and a spline's swing at the foot of a wall.
_BELOW_SAID_M, _BELOW_SAID_SHARE = 2.0, 0.005


def load_surface(
    load_ground: Callable[[float | None], Dem],
    load: Callable[[tuple[float, float], float | None], Dem],
    name: str,
) -> Dem:
    """Ground with what stands on it, as far beyond the area as both models reach.

    Parameters
    ----------
    load_ground
        The terrain model with a margin in metres around the area; None: what it holds.
    load
        The surface model about a latitude and longitude, likewise.
    name
        Of the surface model, for messages.

    Returns
    -------
    Dem
        The ground, with `top` set.

    Raises
    ------
    TerrainError
        Where either doesn't cover the area, or both cannot be of one place.
    """
    ground = load_ground(None)
    centre = ground.origin.lat_deg, ground.origin.lon_deg
    surface = load(centre, None)
    margin_m = min(ground.half_extent_m, surface.half_extent_m)[0] - ground.size_m[0] / 2
    if surface.half_extent_m != ground.half_extent_m:
        if surface.half_extent_m > ground.half_extent_m:
            surface = load(centre, margin_m)
        else:
            ground = load_ground(margin_m)
    return _together(ground, surface, name)


def _together(ground: Dem, surface: Dem, name: str) -> Dem:
    finer = max(ground, surface, key=lambda dem: dem.surface.shape)
    x, y, _ = finer.grid()
    nodes = np.meshgrid(x, y)
    bare = ground.height(*nodes)
    # Both frames stand on the same plumb line, at altitudes of their own.
    above = surface.height(*nodes) + (surface.origin.alt_m - ground.origin.alt_m)
    over = above - bare
    median_m = float(np.median(over))
    if not _LOWEST_M <= median_m <= _HIGHEST_M:
        raise TerrainError(
            f"{name} lies {abs(median_m):.0f} m {'above' if median_m > 0 else 'below'} the terrain "
            "model in half of the area: they are of other places, or their heights of other units "
            "or datums. Declare terrain.vertical_datum or terrain.vertical_unit, or name the "
            "surface model of this terrain."
        )
    return replace(
        ground,
        top=CubicSurface.through(np.maximum(bare, above), x[0], y[0], x[1] - x[0], y[1] - y[0]),
        description=f"{ground.description}; surface {surface.description}, "
        f"{median_m:.1f} m above the ground in the median, at most {float(over.max()):.1f} m",
        notes=(*ground.notes, *surface.notes, *_said(ground, surface, over, name)),
    )


def _said(ground: Dem, surface: Dem, over: Array, name: str) -> tuple[str, ...]:
    said = []
    if ground.height_datum != surface.height_datum:
        said.append(
            f"{name} has heights above {surface.height_datum}, the terrain model above "
            f"{ground.height_datum}: both are taken for one sea level"
        )
    below = over < -_BELOW_SAID_M
    if below.mean() > _BELOW_SAID_SHARE:
        said.append(
            f"{name} lies up to {-float(over.min()):.1f} m below the terrain model, at "
            f"{100 * float(below.mean()):.1f} % of the places by more than {_BELOW_SAID_M:.0f} m; "
            "the ground is taken there"
        )
    return tuple(said)
