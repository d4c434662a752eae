"""Figures fit for a paper: one file per subject, one style for all, each as PNG and PDF."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from pathlib import Path

from matplotlib.figure import Figure

from jfto.analysis.comparison import Comparison
from jfto.analysis.facts import FlightFacts
from jfto.console.progress import SILENT, Progress
from jfto.reporting.figures.motion import flight_profiles, flown_timing
from jfto.reporting.figures.network import degree_and_energy, flown_network, throughput_over_slots
from jfto.reporting.figures.routes import flown_map, route_map
from jfto.reporting.figures.safety import flown_certificate, flown_events
from jfto.reporting.figures.style import save
from jfto.reporting.figures.topology import topology_panels
from jfto_msgs_py.records.plan import Plan
from jfto_world.terrain import Dem

Drawings = Mapping[str, Callable[[], Figure]]


def plan_drawings(plan: Plan, comparison: Comparison, dem: Dem | None, slot: int) -> Drawings:
    """What is drawn of a plan, by file stem; maps need the terrain and show links of one slot.

    A fleet of one has no links to draw.
    """
    slot = min(slot, plan.slots.count)
    drawings: dict[str, Callable[[], Figure]] = {}
    if len(plan.uavs) > 1:
        drawings["throughput"] = lambda: throughput_over_slots(plan, comparison)
        drawings["degree_energy"] = lambda: degree_and_energy(plan, comparison)
    if dem is not None:
        drawings["routes"] = lambda: route_map(plan, dem)
        drawings["flight"] = lambda: flight_profiles(plan, dem)
        if len(plan.uavs) > 1:
            drawings["topology"] = lambda: topology_panels(plan, comparison, dem, slot)
    return drawings


def flight_drawings(facts: FlightFacts, dem: Dem | None) -> Drawings:
    """What is drawn of a flight, by file stem; the map needs the terrain, links need two UAVs."""
    maps: Drawings = {} if dem is None else {"flown_map": lambda: flown_map(facts, dem)}
    links: Drawings = {
        "flown_certificate": lambda: flown_certificate(facts),
        "flown_network": lambda: flown_network(facts),
    }
    return {
        **maps,
        "flown_timing": lambda: flown_timing(facts),
        **(links if len(facts.plan.uavs) > 1 else {}),
        "flown_events": lambda: flown_events(facts),
    }


def draw(drawings: Drawings, folder: Path, progress: Progress = SILENT) -> tuple[Path, ...]:
    """Write `stem`.png and `stem`.pdf of every drawing to `folder`; returns these files."""
    progress.begin("figures", "drawing")
    folder.mkdir(parents=True, exist_ok=True)
    files: list[Path] = []
    for done, (stem, figure) in enumerate(drawings.items()):
        with warnings.catch_warnings():
            # What it does with few or missing data is seen in the figure; an operator cannot act.
            warnings.filterwarnings("ignore", module="matplotlib")
            warnings.filterwarnings("ignore", category=RuntimeWarning, module="numpy")
            files += save(figure(), folder / stem)
        progress.advance((done + 1) / len(drawings))
    progress.end("figures", f"{len(drawings)} figures", f"{folder}/*.png, *.pdf")
    return tuple(files)
