"""Waypoints in compact groups of equal weight, by cutting the map in two again and again."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array, Ints

# Places that differ by less count as one along a cut, so that a last bit decides nothing.
_DECIMALS = 6


def divide(waypoints_m: Array, weights: ArrayLike, count: int) -> tuple[Ints, ...]:
    """Groups of waypoints, each of which lies together on the map, of about equal weight.

    The waypoints are cut across their longest direction into two parts that weigh as their shares
    of the groups do, and the parts likewise. It has no chance in it.

    Parameters
    ----------
    waypoints_m
        Waypoints (W, 2) or (W, 3), ENU metres; heights do not count.
    weights
        What each takes of a sortie (W,), positive.
    count
        Groups, 1 … W.

    Returns
    -------
    tuple of Ints
        Indices of the waypoints of each group, ascending; every waypoint is in one of them.

    Raises
    ------
    InputError
        There are fewer waypoints than groups.
    """
    places = np.asarray(waypoints_m, dtype=np.float64)[:, :2]
    weight = np.asarray(weights, dtype=np.float64)
    if not 1 <= count <= len(places):
        raise InputError(
            f"{len(places)} waypoints cannot be divided into {count} sorties: give 1 to "
            f"{len(places)}."
        )
    return tuple(np.sort(group) for group in _cut(places, weight, np.arange(len(places)), count))


def _cut(places: Array, weight: Array, group: Ints, count: int) -> list[Ints]:
    if count == 1:
        return [group]
    first = count // 2
    along = np.round((places[group] - places[group].mean(axis=0)) @ _longest(places[group]), 6)
    order = group[np.argsort(along, kind="stable")]
    share = np.cumsum(weight[order]) - 0.5 * weight[order]
    size = int(np.searchsorted(share, weight[order].sum() * first / count))
    # Each part must have a waypoint for each of its groups.
    size = min(max(size, first), len(group) - (count - first))
    return [
        *_cut(places, weight, order[:size], first),
        *_cut(places, weight, order[size:], count - first),
    ]


def _longest(places: Array) -> Array:
    """Unit vector (2,) along which places (M, 2) spread most, eastward or else northward."""
    away = places - places.mean(axis=0)
    spread = np.round(away.T @ away, _DECIMALS)
    vector = np.asarray(np.linalg.eigh(spread)[1][:, 1])
    lead = vector[0] if abs(vector[0]) > 1e-9 else vector[1]
    return vector if lead >= 0 else -vector
