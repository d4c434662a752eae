"""Maps of the terrain with everybody's route, as planned and as flown."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jfto.analysis.facts import FlightFacts
from jfto.analysis.motion import motions
from jfto.reporting.figures.map import draw_pad, finish_map, new_map
from jfto.reporting.figures.style import (
    TROUBLE_COLOUR,
    styled,
    uav_style,
)
from jfto.reporting.palette import uav_colour
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array
from jfto_world.terrain import Dem


@styled
def route_map(plan: Plan, dem: Dem) -> Figure:
    """Hillshade, routes with their direction, waypoints and pads."""
    figure, axes = new_map(plan, dem)
    photos = {waypoint.id for waypoint in plan.waypoints if waypoint.photo}
    for index, (uav, route) in enumerate(zip(plan.uavs, plan.routes, strict=True)):
        line = plan.line_m(index)
        colour = uav_colour(index)
        axes.plot(*line[:, :2].T, color="white", linewidth=2.6, alpha=0.85, zorder=3)
        count = len(photos.intersection(route.waypoint_ids))
        label = f"{uav.id}  {route.length_m / 1000:.2f} km, {count} waypoints"
        axes.plot(
            *line[:, :2].T,
            **uav_style(index, 3.4),
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


def _draw_direction(axes: Axes, line: Array, colour: str) -> None:
    """Arrow heads at a quarter, half and three quarters of a route."""
    steps = np.linalg.norm(np.diff(line[:, :2], axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    if along[-1] <= 0:
        return
    for part in (0.2, 0.5, 0.8):
        leg = min(int(np.searchsorted(along, part * along[-1])), len(steps)) - 1
        start, end = line[max(leg, 0), :2], line[max(leg, 0) + 1, :2]
        middle = 0.5 * (start + end)
        axes.annotate(
            "",
            xy=tuple(middle + 0.001 * (end - start)),
            xytext=tuple(middle),
            arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.2},
            zorder=6,
        )


@styled
def flown_map(facts: FlightFacts, dem: Dem) -> Figure:
    """Planned flight white under the flown track in the UAV's colour; what went wrong is marked."""
    plan = facts.plan
    figure, axes = new_map(plan, dem, fade=0.15)
    for index, (uav, planned) in enumerate(zip(plan.uavs, motions(plan), strict=True)):
        colour = uav_colour(index)
        axes.plot(*planned.position_m[:, :2].T, color="white", linewidth=3.0, zorder=3)
        axes.plot(
            *planned.position_m[:, :2].T,
            color="#333333",
            linewidth=0.7,
            linestyle=(0, (2, 2)),
            zorder=4,
        )
        track = facts.flight.tracks[uav.id]
        in_mission = (track.times_s >= 0) & (track.times_s <= facts.grid.times_s[-1])
        home = track.times_s > facts.grid.times_s[-1]
        mine = [one for one in facts.passages if one.uav == uav.id]
        label = f"{uav.id}  {sum(one.visited for one in mine)} of {len(mine)} waypoints"
        axes.plot(
            *track.position_m[in_mission, :2].T, color=colour, linewidth=1.3, zorder=5, label=label
        )
        axes.plot(*track.position_m[home, :2].T, color=colour, linewidth=0.6, alpha=0.6, zorder=5)
        draw_pad(axes, uav.start_m, colour)
    _mark_waypoints(axes, facts)
    _mark_exceptions(axes, facts)
    axes.plot([], [], color="#333333", linewidth=0.7, linestyle=(0, (2, 2)), label="planned")
    axes.plot([], [], color="#777777", linewidth=0.6, label="way home")
    finish_map(axes)
    return figure


def _mark_waypoints(axes: Axes, facts: FlightFacts) -> None:
    where = {waypoint.id: waypoint.position_m for waypoint in facts.plan.waypoints}
    visited = [where[one.waypoint_id] for one in facts.passages if one.visited]
    missed = [where[one.waypoint_id] for one in facts.passages if not one.visited]
    for places, marker, size, colour, label in (
        (visited, "o", 2.0, "#333333", "waypoint visited"),
        (missed, "x", 6.0, TROUBLE_COLOUR, "waypoint missed"),
    ):
        if places:
            axes.plot(
                *np.array(places)[:, :2].T,
                linestyle="none",
                marker=marker,
                markersize=size,
                color=colour,
                markeredgewidth=1.4 if marker == "x" else 0.5,
                zorder=7,
                label=label,
            )


def _mark_exceptions(axes: Axes, facts: FlightFacts) -> None:
    """A ring where each UAV was when its exception began."""
    ids = facts.flight.uav_ids
    places = []
    for one in facts.certificate.exceptions:
        row = min(int(np.searchsorted(facts.grid.times_s, one.time_s)), len(facts.grid.times_s) - 1)
        for uav in one.uav.split("+"):
            if uav in ids:
                places.append(facts.grid.position_m[row, ids.index(uav), :2])
    if places:
        axes.plot(
            *np.array(places).T,
            linestyle="none",
            marker="o",
            markersize=9,
            markerfacecolor="none",
            markeredgecolor=TROUBLE_COLOUR,
            markeredgewidth=1.4,
            zorder=8,
            label="exception",
        )
