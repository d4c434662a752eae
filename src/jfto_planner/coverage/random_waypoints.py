"""Random sets of waypoints, for studies."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.plan import Waypoint
from jfto_msgs_py.types import Array
from jfto_world.terrain import Dem

KINDS = ("uniform", "gaussian")
# Three standard deviations reach from the middle to the edge of the area.
_GAUSSIAN_SHARE = 1 / 6
# Of `count` points each, before an area of slivers far apart is given up.
_MOST_ROUNDS = 10_000


def random_waypoints(
    kind: str, count: int, dem: Dem, height_m: float, rng: np.random.Generator
) -> tuple[Waypoint, ...]:
    """Waypoints above the ground of the area, looking straight down.

    Parameters
    ----------
    kind
        "uniform" over the area, or "gaussian" about the middle of its bounds with a standard
        deviation of a sixth of each side, redrawn where it falls outside.
    count
        How many.
    dem
        The ground.
    height_m
        Above the ground.
    rng
        Where chance comes from.

    Returns
    -------
    tuple of Waypoint
        Numbered from 0.

    Raises
    ------
    InputError
        An argument is out of range.
    """
    if kind not in KINDS:
        raise InputError(f"Kind of random waypoints is {kind!r}, must be one of {KINDS}.")
    if count < 1:
        raise InputError(f"Number of random waypoints is {count}, must be 1 or more.")
    if not 0 < height_m < np.inf:
        raise InputError(f"Height of random waypoints is {height_m} m, must be positive.")
    place = _draw(kind, count, dem, rng)
    z = dem.height(place[:, 0], place[:, 1]) + height_m
    return tuple(
        Waypoint(number, (float(x), float(y), float(up)))
        for number, ((x, y), up) in enumerate(zip(place, z, strict=True))
    )


def _draw(kind: str, count: int, dem: Dem, rng: np.random.Generator) -> Array:
    """Points (count, 2) of the area."""
    size = np.array(dem.size_m)
    middle = np.zeros(2)
    if dem.area:
        west, south, east, north = dem.area_shape.bounds
        size = np.array([east - west, north - south])
        middle = np.array([east + west, north + south]) / 2
    if kind == "uniform" and not dem.area:
        return np.asarray((rng.random((count, 2)) - 0.5) * size)
    place = np.empty((0, 2))
    for _ in range(_MOST_ROUNDS):
        if len(place) >= count:
            return place[:count]
        if kind == "uniform":
            drawn: Array = (rng.random((count, 2)) - 0.5) * size
        else:
            drawn = rng.normal(size=(count, 2)) * size * _GAUSSIAN_SHARE
        drawn = drawn + middle
        place = np.concatenate([place, drawn[dem.in_area(*drawn.T)]])
    raise InputError("The area fills too little of its bounds to draw in it. Survey a part of it.")
