"""Numbers by which topologies are compared."""

from jfto_topology.metrics.connectivity import components, connectivity_rate, largest_component
from jfto_topology.metrics.degree import DegreeStatistics, degree_statistics
from jfto_topology.metrics.energy import energy_used, first_unpaid_slot, traverses_all
from jfto_topology.metrics.hops import average_hops, hop_counts
from jfto_topology.metrics.throughput import slot_throughput, total_throughput

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
