"""Numbers by which topologies are compared."""

from jfto_topology.metrics.graph import (
    DegreeStatistics,
    average_hops,
    components,
    connectivity_rate,
    degree_statistics,
    hop_counts,
    largest_component,
)
from jfto_topology.metrics.transmission import (
    energy_used,
    first_unpaid_slot,
    slot_throughput,
    total_throughput,
    traverses_all,
)

__all__ = [
    "DegreeStatistics",
    "average_hops",
    "components",
    "connectivity_rate",
    "degree_statistics",
    "energy_used",
    "first_unpaid_slot",
    "hop_counts",
    "largest_component",
    "slot_throughput",
    "total_throughput",
    "traverses_all",
]
