"""Powers for a graph of your own: the most throughput within intervals and energy budgets.

python examples/allocate_power.py
"""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.units import dbm_to_w
from jfto_power import PowerProblem, allocate
from jfto_topology import slot_throughput
from jfto_world.radio import make_channel, pairwise_distances

SLOTS, SLOT_S = 40, 1.0


def main() -> None:
    """Four UAVs in a ring that breathes; two of them are short of energy."""
    # Who is linked with whom, in every slot: a ring, 1-2-3-4-1.
    ring = np.roll(np.eye(4, dtype=bool), 1, axis=1)
    adjacency = np.broadcast_to(ring | ring.T, (SLOTS + 1, 4, 4))

    # Where they are decides the gains, (slots, UAVs, UAVs); yours may come from measurements.
    side_m = 400 + 150 * np.sin(np.linspace(0, 2 * np.pi, SLOTS + 1))
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    positions_m = side_m[:, None, None] * corners
    radio = Radio()
    gain = make_channel(radio).gain(pairwise_distances(positions_m))

    # A link needs the sensitivity at its far end; nobody may send louder than 27 dBm.
    needed_w = np.where(adjacency, dbm_to_w(radio.sensitivity_dbm) / gain, 0.0).max(axis=2)
    loudest_w = np.full_like(needed_w, dbm_to_w(27.0))
    energy_j = np.array([20.0, 12.0, 20.0, 12.0])

    best = allocate(PowerProblem(adjacency, gain, needed_w, loudest_w, energy_j, SLOT_S, radio))

    def mean_mbps(power_w: np.ndarray) -> float:
        return float(slot_throughput(adjacency, gain, power_w, radio)[1:].mean() / 1e6)

    print(f"least powers  {mean_mbps(needed_w):6.1f} Mb/s")
    print(f"allocated     {mean_mbps(best.power_w):6.1f} Mb/s")
    for index, (used_j, price) in enumerate(zip(best.energy_j, best.multiplier, strict=True)):
        print(
            f"uav{index + 1} spends {used_j:4.1f} of {energy_j[index]:.0f} J; "
            f"one more would add {price / 1e6:.2f} Mb/s, summed over slots and directions"
        )


if __name__ == "__main__":
    main()
