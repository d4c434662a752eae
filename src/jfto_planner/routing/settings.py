"""How much effort the search spends, and how."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.errors import InputError


@dataclass(frozen=True)
class SearchSettings:
    """Effort of the search.

    Parameters
    ----------
    moves
        Moves tried in all, over all starts; None only together with a time limit.
    starts
        Independent runs, the best of which counts; a plan depends on it but not on `workers`.
    time_limit_s
        Stop after this time, even if moves are left; the plan then depends on the machine.
    workers
        Threads; None for one per core.
    ruin_share
        Share of moves that ruin and recreate part of the routes, the others are local.
    hottest, coldest
        First and last temperature of the annealing, as a share of the mean distance between a
        waypoint and its nearest one.
    """

    moves: int | None = 24_000_000
    starts: int = 4
    time_limit_s: float | None = None
    workers: int | None = None
    ruin_share: float = 0.15
    hottest: float = 0.7
    coldest: float = 0.03

    def __post_init__(self) -> None:
        if self.moves is None and self.time_limit_s is None:
            raise InputError("search.moves and search.time_limit_s are both None; give one.")
        if self.moves is not None and self.moves < 1:
            raise InputError(f"search.moves is {self.moves}, must be at least 1.")
        if self.starts < 1:
            raise InputError(f"search.starts is {self.starts}, must be at least 1.")
        if self.time_limit_s is not None and not self.time_limit_s > 0:
            raise InputError(f"search.time_limit_s is {self.time_limit_s}, must be positive.")
        if self.workers is not None and self.workers < 1:
            raise InputError(f"search.workers is {self.workers}, must be at least 1.")
        if not 0 <= self.ruin_share <= 1:
            raise InputError(f"search.ruin_share is {self.ruin_share}, must be 0 to 1.")
        if not 0 < self.coldest <= self.hottest:
            raise InputError(
                f"search.coldest is {self.coldest} and search.hottest {self.hottest}; "
                "they must be positive, the coldest not above the hottest."
            )
