"""Map of the terrain with everybody's route."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from jfto.report.figures.base_map import draw_pad, finish_map, new_map
from jfto.report.figures.style import (
    styled,
    uav_dash,
    uav_marker,
    uav_marker_size,
)
from jfto.report.palette import uav_colour
from jfto_msgs_py.plan import Plan
from jfto_world.terrain import Dem


@styled
def route_map(plan: Plan, dem: Dem) -> Figure:
    """Hillshade, routes with their direction, waypoints and pads."""
    figure, axes = new_map(plan, dem)
    by_id = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
    for index, (uav, route) in enumerate(zip(plan.uavs, plan.routes, strict=True)):
        line = np.array([uav.start_m, *(by_id[number] for number in route.waypoint_ids)])
        colour = uav_colour(index)
        axes.plot(*line[:, :2].T, color="white", linewidth=2.6, alpha=0.85, zorder=3)
        label = f"{uav.id}  {route.length_m / 1000:.2f} km, {len(route.waypoint_ids)} waypoints"
        axes.plot(
            *line[:, :2].T,
            color=colour,
            linestyle=uav_dash(index),
            marker=uav_marker(index),
            markersize=uav_marker_size(index, 3.4),
            markeredgecolor="white",
            markeredgewidth=0.3,
            linewidth=1.3,
            zorder=4,
            label=label,
        )
        _draw_direction(axes, line, colour)
        draw_pad(axes, uav.start_m, colour)
    finish_map(axes, f"{plan.total_length_m / 1000:.2f} km in all")
    return figure


def _draw_direction(axes: object, line: np.ndarray, colour: str) -> None:
    """Arrow heads at a quarter, half and three quarters of a route."""
    steps = np.linalg.norm(np.diff(line[:, :2], axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    if along[-1] <= 0:
        return
    for part in (0.2, 0.5, 0.8):
        leg = min(int(np.searchsorted(along, part * along[-1])), len(steps)) - 1
        start, end = line[max(leg, 0), :2], line[max(leg, 0) + 1, :2]
        middle = 0.5 * (start + end)
        axes.annotate(  # type: ignore[attr-defined]
            "",
            xy=middle + 0.001 * (end - start),
            xytext=middle,
            arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.2},
            zorder=6,
        )
