"""The topology that carries most, by mixed-integer programming: what elastic C-TOP is held against.

One slot at a time, with the degree rule and connection, without the energy over the horizon: a
bound for any algorithm that lists K_min to K_min + δ neighbours.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from jfto_topology.algorithms.elastic import Air
from jfto_topology.algorithms.intervals import power_intervals, ring_powers
from jfto_topology.algorithms.required_power import required_powers_of_gain


def optimal_bits(air: Air, k_min: int, delta: int) -> float:
    """Most that the links of the air's first slot carry together, bit/s/Hz; NaN if none is allowed.

    Cuts join the components of a solution that falls apart, until one is connected.
    """
    program = _Program(air, k_min, delta)
    while True:
        bits, linked = program.solve()
        if linked is None:
            return bits
        parts, label = connected_components(linked, directed=False)
        if parts == 1:
            return bits
        for part in range(parts):
            if not program.join(label == part):
                return np.nan


class _Program:
    """Variables: a link x; y, who is a UAV's farthest; w, that it sends to b with f its farthest.

    Constraints are rows of (variable, factor) with a lower and an upper bound.
    """

    def __init__(self, air: Air, k_min: int, delta: int) -> None:
        required_w = required_powers_of_gain(air.gain[:1], air.p_max_w, air.sensitivity_w)
        ring_w = ring_powers(required_w)
        self.uavs = len(air.p_max_w)
        pairs = np.argwhere(np.triu(np.isfinite(required_w[0]), 1)).tolist()
        self.x = {(a, b): k for k, (a, b) in enumerate(pairs)}
        self.x |= {(b, a): k for (a, b), k in self.x.items()}
        near = {a: [b for b in range(self.uavs) if (a, b) in self.x] for a in range(self.uavs)}
        self.y = {pair: len(pairs) + k for k, pair in enumerate(self.x)}
        triples = [
            (a, f, b) for a, f in self.y for b in near[a] if ring_w[0, a, b] <= ring_w[0, a, f]
        ]
        self.w = {each: len(pairs) + len(self.y) + k for k, each in enumerate(triples)}
        self.rows: list[tuple[list[tuple[int, float]], float, float]] = []
        for a, others in near.items():
            least = min(k_min, len(others))
            self.rows.append(([(self.y[a, f], 1) for f in others], 0, 1))
            links = [(self.x[a, b], 1.0) for b in others]
            self.rows.append((links, least, max(k_min + delta, least)))
        for (a, b), link in self.x.items():
            sent = [(self.w[a, f, b], 1.0) for f in near[a] if (a, f, b) in self.w]
            self.rows.append(([*sent, (link, -1)], 0, 0))
        for (a, f, b), sends in self.w.items():
            # The farthest itself is listed; others may be.
            self.rows.append(([(sends, 1), (self.y[a, f], -1)], 0 if b == f else -1, 0))
        self.cost = np.zeros(len(pairs) + len(self.y) + len(self.w))
        for (a, f, b), sends in self.w.items():
            only = np.zeros(required_w.shape, dtype=bool)
            only[0, a, f] = True
            power_w = power_intervals(required_w, ring_w, only, air.p_max_w)[2][0, a]
            self.cost[sends] = -0.5 * np.log2(1 + power_w * air.gain[0, a, b] / air.noise_w)
        self.whole = np.arange(len(self.cost)) < len(pairs) + len(self.y)

    def join(self, part: np.ndarray) -> bool:
        """Demand a link out of a part (A,) of the fleet; whether there can be one."""
        crossing = {k for (a, b), k in self.x.items() if part[a] != part[b]}
        self.rows.append(([(k, 1) for k in crossing], 1, np.inf))
        return bool(crossing)

    def solve(self) -> tuple[float, np.ndarray | None]:
        """What the best links carry, and these (A, A); NaN and None where none are allowed."""
        entries = [(r, k, v) for r, (row, _, _) in enumerate(self.rows) for k, v in row]
        r, k, v = zip(*entries, strict=True)
        matrix = coo_matrix((v, (r, k)), shape=(len(self.rows), len(self.cost)))
        limits = LinearConstraint(matrix, [row[1] for row in self.rows], [w[2] for w in self.rows])
        found = milp(self.cost, integrality=self.whole, bounds=Bounds(0, 1), constraints=limits)
        if found.x is None:
            return np.nan, None
        linked = np.zeros((self.uavs, self.uavs), dtype=bool)
        for pair, link in self.x.items():
            linked[pair] = found.x[link] > 0.5
        return float(-found.fun), linked
