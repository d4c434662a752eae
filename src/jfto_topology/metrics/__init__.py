"""Numbers by which topologies are compared."""

from jfto_topology.metrics.graph import (
    average_hops,
    components,
    connectivity_rate,
    hop_counts,
    largest_component,
)
from jfto_topology.metrics.transmission import (
    energy_used,
    slot_throughput,
)

__all__ = [
    "average_hops",
    "components",
    "connectivity_rate",
    "energy_used",
    "hop_counts",
    "largest_component",
    "slot_throughput",
]
