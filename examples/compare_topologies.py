"""Topology controls on tracks of your own: arrays in, links, powers and metrics out.

python examples/compare_topologies.py
"""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.units import dbm_to_w
from jfto_topology import a_lmst, average_hops, connectivity_rate, cpapo, ctop, mtp, slot_throughput
from jfto_world.radio import make_channel, pairwise_distances

SLOTS, UAVS, SLOT_S, SPEED_MPS = 60, 6, 2.0, 8.0


def tracks() -> np.ndarray:
    """Six UAVs on circles beside one another, (slots, UAVs, 3) in metres: put yours here."""
    turn = 2 * np.pi * np.arange(SLOTS)[:, None] / SLOTS + np.arange(UAVS)
    middle = 350.0 * np.arange(UAVS)
    return np.stack(
        [middle + 150 * np.cos(turn), 150 * np.sin(turn), np.full_like(turn, 100.0)], axis=-1
    )


def main() -> None:
    """Print throughput, ξ, hops and degrees of four algorithms on the same tracks.

    C-TOP gives intervals: here each UAV sends at the lower end, `allocate` finds the best powers.
    """
    positions_m = tracks()
    radio = Radio()  # 2.44 GHz, 3 dBi each, -70 dBm, 83.5 MHz; name what differs
    channel, sensitivity_w = make_channel(radio), float(dbm_to_w(radio.sensitivity_dbm))
    p_max_w, energy_j = dbm_to_w(np.full(UAVS, 27.0)), np.full(UAVS, 40.0)
    fleet = (positions_m, channel, p_max_w, sensitivity_w)

    ours = ctop(*fleet, k_min=1, delta=2)
    others = {
        "MTP": mtp(*fleet, energy_j, SLOT_S),
        "A-LMST": a_lmst(*fleet, energy_j, SLOT_S, np.full(UAVS, SPEED_MPS)),
        "CPAPO": cpapo(*fleet, energy_j, SLOT_S),
    }
    found = {name: (each.adjacency, each.power_w) for name, each in others.items()}
    found["C-TOP"] = ours.adjacency, ours.p_min_w
    gain = channel.gain(pairwise_distances(positions_m))
    for name, (links, power_w) in found.items():
        rate_mbps = slot_throughput(links, gain, power_w, radio).mean() / 1e6
        degree = links.sum(axis=2)
        print(
            f"{name:7} {rate_mbps:6.0f} Mb/s   ξ {100 * connectivity_rate(links, 18):5.1f} %   "
            f"hops {average_hops(links):4.2f}   neighbours {degree.min()} to {degree.max()}   "
            f"{power_w[1:].sum(axis=0).mean() * SLOT_S:5.1f} J per UAV"
        )


if __name__ == "__main__":
    main()
