"""Decides who is whose neighbour: C-TOP, the baselines and the metrics that compare them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_msgs_py.lazy import lazy_names

if TYPE_CHECKING:
    from jfto_topology.algorithms.cpapo import cpapo
    from jfto_topology.algorithms.ctop import Topology, ctop
    from jfto_topology.algorithms.elastic import Air, ctop_elastic
    from jfto_topology.algorithms.lmst import a_lmst
    from jfto_topology.algorithms.mtp import mtp
    from jfto_topology.metrics import average_hops, connectivity_rate, slot_throughput

__all__ = [
    "Air",
    "Topology",
    "a_lmst",
    "average_hops",
    "connectivity_rate",
    "cpapo",
    "ctop",
    "ctop_elastic",
    "mtp",
    "slot_throughput",
]
__getattr__ = lazy_names(
    __name__,
    {
        "Air": "jfto_topology.algorithms.elastic",
        "ctop_elastic": "jfto_topology.algorithms.elastic",
        "Topology": "jfto_topology.algorithms.ctop",
        "ctop": "jfto_topology.algorithms.ctop",
        "mtp": "jfto_topology.algorithms.mtp",
        "a_lmst": "jfto_topology.algorithms.lmst",
        "cpapo": "jfto_topology.algorithms.cpapo",
        "average_hops": "jfto_topology.metrics",
        "connectivity_rate": "jfto_topology.metrics",
        "slot_throughput": "jfto_topology.metrics",
    },
)
