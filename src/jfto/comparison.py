"""What the four topology algorithms make of one plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

OURS = "C-TOP"
ALGORITHMS = ("MTP", "A-LMST", "CPAPO", OURS)


@dataclass(frozen=True)
class AlgorithmResult:
    """One algorithm on one plan; slots n = 0 … N on axis 0.

    `adjacency` (N + 1, A, A) and `power_w` (N + 1, A) are what it decides, depleted UAVs off the
    air; `throughput_bps` (N + 1,) the network throughput of each slot; `degree` (N + 1, A);
    `energy_j` (A,) what slots 1 … N cost. `traverses_all` says that no UAV runs out of energy
    before the fleet is done. `connectivity_rate` is ξ, `hops` the mean shortest path, inf where
    some slot is disconnected.
    """

    name: str
    adjacency: Flags
    power_w: Array
    throughput_bps: Array
    degree: NDArray[np.int64]
    energy_j: Array
    traverses_all: bool
    connectivity_rate: float
    hops: float

    @property
    def mean_throughput_mbps(self) -> float:
        """Network throughput in Mb/s, mean over slots 1 … N."""
        return float(self.throughput_bps[1:].mean() / 1e6)


@dataclass(frozen=True)
class Comparison:
    """All algorithms on one plan, in the order of the paper's tables, C-TOP last.

    `gain` (N + 1, A, A) holds the linear link gains, `reach` (N + 1, A, A) the pairs that hear
    each other at C-TOP's powers; `margin_db` (N + 1, A, A) is the surplus over the sensitivity on
    C-TOP's links at its powers, NaN elsewhere. `notes` say what an algorithm could not keep.
    """

    results: tuple[AlgorithmResult, ...]
    gain: Array
    reach: Flags
    margin_db: Array
    n_dc: int
    notes: tuple[str, ...]

    @property
    def ours(self) -> AlgorithmResult:
        """C-TOP's result."""
        return next(result for result in self.results if result.name == OURS)
