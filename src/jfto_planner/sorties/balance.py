"""The division of waypoints into a number of sorties that is evened out by how long each takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Ints
from jfto_planner.sorties.divide import divide

# Divisions that are tried for one number of sorties, and loads that are as good as equal.
ROUNDS, EVEN = 4, 0.05
# A sortie that breaks its rules counts as this full at least; this full, on average, no other
# division helps.
BROKEN, HOPELESS = 1.05, 1.25


@dataclass(frozen=True)
class Load:
    """What planning a sortie came to: the share of what its fleet may spend, 1 being all of it, and
    the length of its routes in metres. `clean` says whether it keeps every rule.
    """

    share: float
    clean: bool
    length_m: float

    @property
    def weight(self) -> float:
        """The share, of a sortie that breaks rules more than there is."""
        return self.share if self.clean else max(self.share, BROKEN)


@dataclass(frozen=True)
class Split:
    """Waypoints of each sortie, as indices, and what each came to."""

    groups: tuple[Ints, ...]
    loads: tuple[Load, ...]

    @property
    def clean(self) -> bool:
        """Whether every sortie keeps every rule."""
        return all(load.clean for load in self.loads)

    @property
    def rank(self) -> tuple[int, float, float]:
        """Less is better: broken sorties, then the fullest one, then the length of all."""
        broken = sum(not load.clean for load in self.loads)
        fullest = max(load.weight for load in self.loads)
        return broken, round(fullest, 3), sum(load.length_m for load in self.loads)


Measure = Callable[[Ints], Load]


def balanced(waypoints_m: Array, count: int, measure: Measure, rounds: int = ROUNDS) -> Split:
    """The best of a few divisions of waypoints (W, 3) into `count` sorties.

    After each, waypoints weigh more where their sortie took more, so that the borders move towards
    it. It ends early with clean sorties of equal loads, and where all together are too much.

    Parameters
    ----------
    waypoints_m
        Waypoints (W, 3), ENU metres.
    count
        Sorties, 1 … W.
    measure
        Plans the waypoints with these indices and says what it came to; asked once for a group.
    rounds
        Divisions to try.

    Returns
    -------
    Split
        Best by `rank`.
    """
    weights, known = np.ones(len(waypoints_m)), dict[bytes, Load]()
    best: Split | None = None
    for _ in range(rounds):
        groups = divide(waypoints_m, weights, count)
        for group in groups:
            if group.tobytes() not in known:
                known[group.tobytes()] = measure(group)
        tried = Split(groups, tuple(known[group.tobytes()] for group in groups))
        repeated = best is not None and _same(best, tried)
        if best is None or tried.rank < best.rank:
            best = tried
        loads = np.array([load.weight for load in tried.loads])
        even = loads.max() <= loads.mean() * (1 + EVEN)
        if repeated or (even and tried.clean) or loads.mean() > HOPELESS or count == 1:
            break
        for group, load in zip(groups, loads, strict=True):
            weights[group] *= load / loads.mean()
    assert best is not None
    return best


def _same(one: Split, other: Split) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(one.groups, other.groups, strict=True))
