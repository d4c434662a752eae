"""What a search found."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_planner.routing.assess import Assessment, Routes


@dataclass(frozen=True)
class SearchResult:
    """Best routes found, or where none satisfies every constraint the closest to it.

    `routes` holds waypoint indices per UAV, `length_m` their summed length; `feasible` says whether
    they keep every rule, `assessment` has the violation totals and the energies. `seconds` is what
    it took by the clock. `stopped_by` is "time limit" or "user" where one of them
    ended the search, else empty. `moves` counts moves tried, `lengths_m` the best sound length of
    each start (inf where it found none).
    """

    routes: Routes
    length_m: float
    feasible: bool
    assessment: Assessment
    moves: int
    seconds: float
    stopped_by: str
    lengths_m: tuple[float, ...]

    @property
    def interrupted(self) -> bool:
        """Whether the search was stopped before it had used its moves."""
        return bool(self.stopped_by)
