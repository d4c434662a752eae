"""Where waypoints come from."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.scenario.key import param

SOURCES = ("coverage", "file", "uniform", "gaussian")


@dataclass(frozen=True)
class WaypointsPart:
    """Source of the waypoints: computed from the terrain, read from a file, or drawn."""

    source: str = param(
        "coverage",
        "coverage: computed so that the camera sees the whole area; file: read; uniform, gaussian: "
        "drawn at random, for studies.",
        choices=SOURCES,
    )
    file: str = param(
        "",
        "For source file: a CSV, GeoJSON or QGroundControl .plan file, relative to the scenario "
        "file.",
    )
    count: int = param(136, "How many are drawn (uniform, gaussian).", low=1, high=100_000)
    height_m: float = param(
        100.0, "Height above ground of drawn waypoints.", unit="m", low=1.0, high=5000.0
    )
    seed: int = param(
        0,
        "Seed of the draw; apart from search.seed, so that several searches face one set.",
        low=0,
        high=2**31 - 1,
    )
