"""What is flown in several sorties, with batteries changed in between."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param

STARTS = ("own", "same")


@dataclass(frozen=True)
class SortiesPart:
    """Several flights of the fleet, where one does not do for all waypoints."""

    count: int = param(
        0,
        "How many flights the waypoints are divided into; 0: as few as are found to do. 1: one "
        "flight, infeasible where it does not do.",
        low=0,
        high=100,
        later=True,
    )
    most: int = param(
        12, "With sorties.count 0, no more than so many.", low=1, high=100, later=True
    )
    starts: str = param(
        "own",
        "Where starting points are chosen: for each sortie by its own waypoints, or the same ones "
        "for all. Those of starts.positions_m are the same anyway.",
        choices=STARTS,
        later=True,
    )
    positions_m: tuple[float, ...] = param(
        (),
        "Places that sorties begin from, east and north of the origin: e1, n1, e2, n2, … A sortie "
        "takes the one nearest to its waypoints, with pads for all UAVs about it, instead of "
        "starts.positions_m.",
        unit="m",
        low=-50_000.0,
        high=50_000.0,
        later=True,
    )
