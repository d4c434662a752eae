"""How many neighbours UAVs have."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_world.radio import degrees


@dataclass(frozen=True)
class DegreeStatistics:
    """Neighbours over all UAVs and slots.

    `histogram[k]` is the share with k neighbours (A,); `below` and `above` the shares outside
    K_min and K_min + δ.
    """

    least: int
    mean: float
    most: int
    below: float
    above: float
    histogram: NDArray[np.float64]


def degree_statistics(adjacency: NDArray[np.bool_], k_min: int, delta: int) -> DegreeStatistics:
    """Degree statistics of a topology (M, A, A), which must hold at least one slot and UAV."""
    degree = degrees(adjacency)
    counts = np.bincount(degree.ravel(), minlength=adjacency.shape[1])
    return DegreeStatistics(
        least=int(degree.min()),
        mean=float(degree.mean()),
        most=int(degree.max()),
        below=float((degree < k_min).mean()),
        above=float((degree > k_min + delta).mean()),
        histogram=counts / degree.size,
    )
