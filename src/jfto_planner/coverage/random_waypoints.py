"""Random sets of waypoints, for studies."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.plan import Waypoint
from jfto_world.terrain import Dem

KINDS = ("uniform", "gaussian")
# Three standard deviations reach from the middle to the edge of the area.
_GAUSSIAN_SHARE = 1 / 6


def random_waypoints(
    kind: str, count: int, dem: Dem, height_m: float, rng: np.random.Generator
) -> tuple[Waypoint, ...]:
    """Waypoints above the ground of the area, looking straight down.

    Parameters
    ----------
    kind
        "uniform" over the area, or "gaussian" about its middle with a standard deviation of a sixth
        of each side, redrawn where it falls outside.
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
    size = np.array(dem.size_m)
    if kind == "uniform":
        place = (rng.random((count, 2)) - 0.5) * size
    else:
        place = np.empty((0, 2))
        while len(place) < count:
            drawn = rng.normal(size=(count, 2)) * size * _GAUSSIAN_SHARE
            place = np.concatenate([place, drawn[(np.abs(drawn) <= size / 2).all(axis=1)]])
        place = place[:count]
    z = dem.height(place[:, 0], place[:, 1]) + height_m
    return tuple(
        Waypoint(number, (float(x), float(y), float(up)))
        for number, ((x, y), up) in enumerate(zip(place, z, strict=True))
    )
