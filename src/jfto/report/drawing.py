"""Figures of a run."""

from __future__ import annotations

from pathlib import Path

from jfto.analysis.comparison import Comparison
from jfto.console.progress import Watcher
from jfto.report.figures.degree_energy import degree_and_energy
from jfto.report.figures.flight_profiles import flight_profiles
from jfto.report.figures.route_map import route_map
from jfto.report.figures.style import save
from jfto.report.figures.throughput import throughput_over_slots
from jfto.report.figures.topology_panels import topology_panels
from jfto_msgs_py.plan import Plan
from jfto_world.terrain import Dem


def draw_figures(
    plan: Plan, comparison: Comparison, dem: Dem | None, slot: int, folder: Path, watcher: Watcher
) -> tuple[str, ...]:
    """Write all figures to `folder`; maps need the terrain. Returns their file stems."""
    watcher.begin("figures", "drawing")
    folder.mkdir(parents=True, exist_ok=True)
    slot = min(slot, plan.slots.count)
    drawings = {
        "throughput": lambda: throughput_over_slots(plan, comparison),
        "degree_energy": lambda: degree_and_energy(plan, comparison),
    }
    if dem is not None:
        drawings["routes"] = lambda: route_map(plan, dem)
        drawings["flight"] = lambda: flight_profiles(plan, dem)
        drawings["topology"] = lambda: topology_panels(plan, comparison, dem, slot)
    for done, (stem, draw) in enumerate(drawings.items()):
        save(draw(), folder / stem)
        watcher.advance((done + 1) / len(drawings))
    watcher.end("figures", f"{len(drawings)} figures", f"{folder}/*.png, *.pdf")
    return tuple(drawings)
