"""Who is linked to whom in one slot, for each algorithm."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jfto.analysis.comparison import AlgorithmResult, Comparison
from jfto.reporting.figures.map import draw_north_arrow, draw_relief, draw_scale_bar, drawn_extent
from jfto.reporting.figures.style import (
    PAGE_WIDTH_IN,
    new_figure,
    styled,
    uav_style,
)
from jfto.reporting.palette import uav_colour
from jfto_msgs_py.records.plan import Plan
from jfto_world.terrain import Dem


@styled
def topology_panels(plan: Plan, comparison: Comparison, dem: Dem, slot: int) -> Figure:
    """One map per algorithm with the links of slot `slot`."""
    positions = plan.positions_m[:, slot]
    extent = drawn_extent(dem, positions)
    rows = -(-len(comparison.results) // 2)
    height = rows / 2 * 0.93 * PAGE_WIDTH_IN * extent[1] / extent[0] + 0.9
    figure = new_figure(PAGE_WIDTH_IN, min(height, 9.5))
    grid = figure.subplots(rows, 2, sharex=True, sharey=True)
    for index, (axes, result) in enumerate(zip(grid.flat, comparison.results, strict=True)):
        draw_relief(axes, dem, extent, fade=0.35)
        _draw_links(axes, positions, result, slot)
        _draw_uavs(axes, plan, result, slot)
        degree = result.degree[slot]
        rate = f"{result.linked.throughput_bps[slot] / 1e6:,.0f}".replace(",", "\u202f")
        span = f"{degree.min()} to {degree.max()}" if np.ptp(degree) else f"{degree.min()}"
        axes.set_title(
            f"({'abcdef'[index]}) {result.name}: {span} neighbours, {rate} Mb/s",
            loc="left",
        )
    for axes in grid[-1]:
        axes.set_xlabel("East of origin (m)")
    for axes in grid[:, 0]:
        axes.set_ylabel("North of origin (m)")
    draw_scale_bar(grid[-1, 0], positions[:, :2])
    draw_north_arrow(grid[0, 1])
    figure.suptitle(
        f"Slot {slot} of {plan.slots.count}, {slot * plan.slots.duration_s:.0f} s after lift-off. "
        "Dotted: in reach, but not listed as neighbours.",
        fontsize=8,
    )
    return figure


def _draw_links(axes: Axes, positions: np.ndarray, result: AlgorithmResult, slot: int) -> None:
    """Active links in full, pairs that merely hear each other dotted."""
    active, linked = result.active.links[slot], result.linked.links[slot]
    for a, b in zip(*np.nonzero(np.triu(linked)), strict=True):
        ends = positions[[a, b], :2]
        if active[a, b]:
            axes.plot(*ends.T, color="#333333", linewidth=1.1, zorder=3)
        else:
            axes.plot(*ends.T, color="#555555", linewidth=0.9, linestyle=(0, (1, 2)), zorder=2)


def _draw_uavs(axes: Axes, plan: Plan, result: AlgorithmResult, slot: int) -> None:
    for index, uav in enumerate(plan.uavs):
        on_air = result.power_w[slot, index] > 0
        x, y = plan.positions_m[index, slot, :2]
        style = uav_style(index, 7)
        if not on_air:
            style |= {"color": "white"}
        edge = "white" if on_air else uav_colour(index)
        axes.plot(x, y, **style, markeredgecolor=edge, markeredgewidth=0.8, zorder=5)
        axes.annotate(
            uav.id if on_air else f"{uav.id} (off)",
            (x, y),
            xytext=(5, 4),
            textcoords="offset points",
            fontsize=6.5,
            zorder=6,
            bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "alpha": 0.6, "linewidth": 0},
        )
