"""The radio rules of a fleet, and the topology that they make of predicted positions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from jfto_msgs_py.records.topology import ELASTIC, LITERAL
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import db_to_ratio
from jfto_topology.algorithms.affordable import affordable
from jfto_topology.algorithms.ctop import Topology
from jfto_topology.algorithms.elastic import Air, elastic_wishes, topology_of_form
from jfto_world.radio import Channel, pairwise_distances

# Standard deviations of measured losses that a margin takes in.
SPREADS = 2.0
# Keeps a link that takes all a radio has from being lost by rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Links:
    """Channel, greatest powers by UAV (W), sensitivity (W), K_min and δ.

    With a `margin_db`, links keep this many dB in hand through the whole slot; `loss_db` is what
    they are believed to lose beyond the channel's loss. `form` is that of C-TOP; the elastic one
    goes by what links carry over `noise_w`.
    """

    channel: Channel
    p_max_w: dict[str, float]
    sensitivity_w: float
    k_min: int
    delta: int
    margin_db: float | None = None
    loss_db: float = 0.0
    form: str = LITERAL
    noise_w: float = math.nan

    def topology(
        self,
        uav_ids: tuple[str, ...],
        positions_m: Array,
        slot_duration_s: float,
        left_j: Mapping[str, float],
    ) -> tuple[Topology, int]:
        """Topology of M slots at `positions_m` (M + 1, A, 3), the last row being their end.

        `left_j` is the energy left to UAVs, as far as it is known. With a margin, one without any
        is nobody's neighbour, and where one cannot pay for all slots, slots give way: first the
        margin goes, then one neighbour after the other, but never the connection of the fleet.
        Returns K_min of the first slot too.
        """
        k_min = min(self.k_min, len(uav_ids) - 1)
        p_max_w = np.array([self.p_max_w[uav_id] for uav_id in uav_ids])
        energy_j = np.array([left_j.get(uav_id, np.inf) for uav_id in uav_ids])
        gain = self.channel.gain(pairwise_distances(positions_m)) * db_to_ratio(-self.loss_db)
        air = Air(gain[:-1], p_max_w, self.sensitivity_w, self.noise_w)
        if self.margin_db is None:
            wishes = self._wishes(air, k_min)
            return affordable(wishes, energy_j, slot_duration_s)[0], k_min
        gain[:, energy_j <= 0] = 0.0
        gain[:, :, energy_j <= 0] = 0.0

        def guarded(margin_db: float) -> Air:
            return replace(air, gain=guarded_gain(gain, p_max_w, self.sensitivity_w, margin_db))

        wishes = self._wishes(guarded(self.margin_db), k_min)
        wanted = [k_min] * len(wishes)
        for k in range(k_min, 0, -1):
            wishes.append(partial(topology_of_form, LITERAL, guarded(0.0), k, self.delta))
            wanted.append(k)
        topology, chosen = affordable(wishes, energy_j, slot_duration_s)
        return topology, wanted[chosen[0]]

    def _wishes(self, air: Air, k_min: int) -> list[Callable[[], Topology]]:
        """Topologies over the air that keep K_min, the most demanding one first."""
        if self.form == ELASTIC:
            return elastic_wishes(air, k_min, self.delta)
        return [partial(topology_of_form, self.form, air, k_min, self.delta)]


def guarded_gain(gain: Array, p_max_w: Array, sensitivity_w: float, margin_db: float) -> Array:
    """Gains (M, A, A) that a link has left at the worse end of its slot, less a margin.

    `gain` is (M + 1, A, A) at the slots' beginnings and at the end of the last one, `p_max_w` (A,)
    in watts. A link that the planned gain makes possible at a slot's beginning stays possible, at
    full power: a margin must not take away what is there.
    """
    now, after = gain[:-1], gain[1:]
    guarded = np.minimum(now, after) * db_to_ratio(-margin_db)
    least = sensitivity_w / np.minimum(p_max_w[:, None], p_max_w[None, :]) * (1 + _ROUNDING)
    return np.where(now >= least, np.maximum(guarded, least), guarded)
