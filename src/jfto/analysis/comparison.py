"""What the four topology algorithms make of one plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.types import Array, Flags

OURS = "C-TOP"
ALGORITHMS = ("MTP", "A-LMST", "CPAPO", OURS)


@dataclass(frozen=True)
class LinkMetrics:
    """What one set of links is worth; slots n = 0 … N on axis 0.

    `links` is (N + 1, A, A); `throughput_bps` (N + 1,) the network throughput of each slot;
    `connectivity_rate` ξ; `hops` the mean shortest path, inf where some slot is disconnected.
    """

    links: Flags
    throughput_bps: Array
    connectivity_rate: float
    hops: float

    @property
    def mean_throughput_mbps(self) -> float:
        """Network throughput in Mb/s, mean over slots 1 … N."""
        return float(self.throughput_bps[1:].mean() / 1e6)


@dataclass(frozen=True)
class AlgorithmResult:
    """One algorithm on one plan.

    `linked` counts every pair that hears each other at the algorithm's powers, the definition of a
    link that is the same for all algorithms; `active` only the links that both ends list, to which
    the neighbour rule applies. `power_w` is (N + 1, A), 0 where a UAV is off the air; `degree`
    (N + 1, A) counts active links; `energy_j` (A,) is what slots 1 … N cost. `traverses_all` says
    that no UAV runs out of energy before the fleet is done.
    """

    name: str
    linked: LinkMetrics
    active: LinkMetrics
    power_w: Array
    degree: NDArray[np.int64]
    energy_j: Array
    traverses_all: bool


@dataclass(frozen=True)
class Comparison:
    """All algorithms on one plan, in the order of the paper's tables, C-TOP last.

    `gain` (N + 1, A, A) holds the linear link gains. `notes` say what C-TOP could not keep.
    """

    results: tuple[AlgorithmResult, ...]
    gain: Array
    n_dc: int
    notes: tuple[str, ...]

    @property
    def ours(self) -> AlgorithmResult:
        """C-TOP's result."""
        return next(result for result in self.results if result.name == OURS)
