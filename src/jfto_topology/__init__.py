"""Decides who is whose neighbour: C-TOP, the baselines and the metrics that compare them."""

from jfto_topology.a_lmst import a_lmst
from jfto_topology.cpapo import cpapo
from jfto_topology.ctop import Topology, ctop, ctop_of_gain
from jfto_topology.energy_floor import energy_floor
from jfto_topology.kept_intervals import kept_intervals
from jfto_topology.mtp import mtp
from jfto_topology.powered import PoweredTopology

__all__ = [
    "PoweredTopology",
    "Topology",
    "a_lmst",
    "cpapo",
    "ctop",
    "ctop_of_gain",
    "energy_floor",
    "kept_intervals",
    "mtp",
]
