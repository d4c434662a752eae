"""Rate to the ground: what every UAV can send to a ground station at once, over several hops.

Pictures are worth nothing before they are down. Throughput summed over links says little of that:
a link carries its own traffic and that of all whom it relays for, and a radio cannot talk to two
at once.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array, Flags

NODE_EXCLUSIVE, ONE_BAND = MACS = ("node_exclusive", "one_band")


def ground_rate(rate_bps: Array, stations: int, mac: str = NODE_EXCLUSIVE) -> Array:
    """Greatest rate that every UAV can send to any of the stations at the same time, by slot.

    The linear programme max r with flows f_ab ≥ 0 on links: each UAV sends r more than it receives,
    stations only take. Airtime: under "node_exclusive" what a node sends and receives takes no more
    than all of its time, Σ_b f_ab / R_ab + f_ba / R_ba ≤ 1; under "one_band" all nodes share one
    channel, Σ f_ab / R_ab ≤ 1 over all links.

    Parameters
    ----------
    rate_bps
        What directed links carry (M, A + S, A + S), bit/s, 0 where there is none; the last S nodes
        are stations.
    stations
        S, at least 1.
    mac
        One of `MACS`.

    Returns
    -------
    array of float
        (M,), bit/s; 0 where some UAV has no way to a station.

    Raises
    ------
    InputError
        For shapes, rates or a number of stations that make no sense.
    """
    rate_bps = np.asarray(rate_bps, dtype=np.float64)
    if rate_bps.ndim != 3 or rate_bps.shape[1] != rate_bps.shape[2]:
        raise InputError(f"rate_bps has shape {rate_bps.shape}, must be (slots, nodes, nodes).")
    if not 1 <= stations < rate_bps.shape[1]:
        raise InputError(f"stations is {stations}, must be from 1 to below the number of nodes.")
    if not (np.isfinite(rate_bps).all() and (rate_bps >= 0).all()):
        raise InputError("rate_bps holds values that are negative or not finite.")
    if mac not in MACS:
        raise InputError(f"mac is {mac!r}, must be one of {', '.join(MACS)}.")
    return np.array([_of_slot(rate, stations, mac) for rate in rate_bps])


def deaf_uavs(linked: Flags, stations: int) -> Flags:
    """UAVs without a way to any station, (M, A); `linked` (M, A + S, A + S), stations last."""
    deaf = np.zeros((len(linked), linked.shape[1] - stations), dtype=np.bool_)
    for slot, links in enumerate(linked):
        _, label = connected_components(links, directed=False)
        deaf[slot] = ~np.isin(label[:-stations], label[-stations:])
    return deaf


def _of_slot(rate: Array, stations: int, mac: str) -> float:
    nodes = len(rate)
    uavs = nodes - stations
    if deaf_uavs(rate[None] > 0, stations).any():
        return 0.0
    # Nothing leaves a station: what it relayed would have arrived.
    sender, receiver = np.nonzero(rate[:uavs])
    links = len(sender)
    # In units of the fastest link, so that the solver's tolerances mean something.
    scale = rate.max()
    airtime = scale / rate[sender, receiver]
    link = np.arange(links)
    taken = receiver < uavs
    balance = coo_matrix(
        (
            np.concatenate([np.ones(links), -np.ones(int(taken.sum())), -np.ones(uavs)]),
            (
                np.concatenate([sender, receiver[taken], np.arange(uavs)]),
                np.concatenate([link, link[taken], np.full(uavs, links)]),
            ),
        ),
        shape=(uavs, links + 1),
    )
    if mac == ONE_BAND:
        time = coo_matrix((airtime, (np.zeros(links, dtype=int), link)), shape=(1, links + 1))
    else:
        time = coo_matrix(
            (
                np.concatenate([airtime, airtime]),
                (np.concatenate([sender, receiver]), np.concatenate([link, link])),
            ),
            shape=(nodes, links + 1),
        )
    goal = np.zeros(links + 1)
    goal[-1] = -1.0
    found = linprog(
        goal,
        A_ub=time.toarray(),
        b_ub=np.ones(time.shape[0]),
        A_eq=balance.toarray(),
        b_eq=np.zeros(uavs),
        method="highs",
    )
    if found.x is None:
        raise InputError(f"rate_bps: the programme of a slot was not solved: {found.message}")
    return float(found.x[-1] * scale)
