"""What all maps of a plan share: relief, pads, axes, scale and north."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jfto.report.figures.relief import draw_north_arrow, draw_relief, draw_scale_bar, drawn_extent
from jfto.report.figures.style import PAGE_WIDTH_IN, new_figure
from jfto_msgs_py.plan import Plan
from jfto_world.terrain import Dem


def new_map(plan: Plan, dem: Dem, fade: float = 0.0) -> tuple[Figure, Axes]:
    """Hillshade of the area with all waypoints and pads; `fade` 0 … 1 pales it."""
    points = np.array([w.position_m for w in plan.waypoints] + [u.start_m for u in plan.uavs])
    extent = drawn_extent(dem, points)
    ratio = extent[1] / extent[0]
    figure = new_figure(PAGE_WIDTH_IN, min(8.5, 0.59 * PAGE_WIDTH_IN * ratio + 0.5))
    axes = figure.add_subplot()
    draw_relief(axes, dem, extent, fade)
    axes.set_xlabel("East of origin (m)")
    axes.set_ylabel("North of origin (m)")
    return figure, axes


def draw_pad(axes: Axes, start_m: tuple[float, float, float], colour: str) -> None:
    """A pad in its UAV's colour."""
    axes.plot(
        *start_m[:2],
        marker="s",
        markersize=7,
        markerfacecolor="white",
        markeredgecolor=colour,
        markeredgewidth=1.6,
        zorder=6,
    )


def finish_map(axes: Axes, title: str | None = None) -> None:
    """Scale, north and the legend, which explains pads too; to be called last."""
    axes.plot(
        [], [], "s", markersize=6, markerfacecolor="white", markeredgecolor="black", label="pad"
    )
    draw_scale_bar(axes)
    draw_north_arrow(axes, outside=True)
    axes.legend(
        loc="upper left",
        bbox_to_anchor=(1.02, 1.0),
        borderaxespad=0.0,
        title=title,
        alignment="left",
    )
