"""How each UAV moves by the plan, and how late and how far off it passed its waypoints."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from jfto.analysis.facts import FlightFacts
from jfto.analysis.motion import Motion, motions
from jfto.reporting.figures.style import (
    PAGE_WIDTH_IN,
    new_figure,
    rule,
    styled,
    uav_style,
)
from jfto.reporting.palette import uav_colour
from jfto_msgs_py.records.passage import VISITED_M
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array
from jfto_world.terrain import Dem

_ROW_IN = 0.78
# A timing error of less than this is of no account, and looks so.
_LEAST_S = 1.0
# Share of all values that an axis shows, and when a take-off's jolts are over.
_SHOWN, _RISEN_S = 0.998, 10.0


@styled
def flight_profiles(plan: Plan, dem: Dem) -> Figure:
    """One row per UAV, one column per quantity; ticks below a curve mark waypoints passed."""
    flights = motions(plan)
    columns: list[tuple[str, Callable[[Motion], Array | None]]] = [
        ("Speed (m/s)", lambda flight: flight.speed_mps),
        ("Acceleration (m/s²)", lambda flight: flight.acceleration_mps2),
        ("Jerk (m/s³)", lambda flight: flight.jerk_mps3),
        ("Height over terrain (m)", lambda flight: _height(flight, dem)),
    ]
    columns = [column for column in columns if column[1](flights[0]) is not None]
    tops = {title: _top(flights, pick) for title, pick in columns}
    rows = len(flights)
    figure = new_figure(PAGE_WIDTH_IN, _ROW_IN * rows + 0.5)
    grid = figure.subplots(rows, len(columns), sharex=True, sharey="col", squeeze=False)
    last_s = max(float(flight.times_s[-1]) for flight in flights)
    for row, (uav, flight, route) in enumerate(zip(plan.uavs, flights, plan.routes, strict=True)):
        for axes, (title, pick) in zip(grid[row], columns, strict=True):
            values = pick(flight)
            assert values is not None, "one time model flies the whole fleet"
            axes.plot(flight.times_s, values, color=uav_colour(row), linewidth=0.7)
            axes.fill_between(
                flight.times_s, values, color=uav_colour(row), alpha=0.15, linewidth=0
            )
            axes.set_ylim(0, tops[title])
            axes.set_xlim(0, last_s)
            rule(axes)
            # An empty line that is not clipped has no extent, and the layout of all would collapse.
            if route.arrival_s:
                axes.plot(
                    route.arrival_s,
                    np.zeros(len(route.arrival_s)),
                    "|",
                    color="#333333",
                    markersize=3.5,
                    markeredgewidth=0.6,
                    clip_on=False,
                )
            if row == 0:
                axes.set_title(title)
            if row == rows - 1:
                axes.set_xlabel("Time (s)")
        grid[row][0].set_ylabel(uav.id, rotation=0, ha="right", va="center", weight="bold")
    return figure


def _top(flights: tuple[Motion, ...], pick: Callable[[Motion], Array | None]) -> float:
    """Top of an axis: a take-off begins with a jolt in the model, which would dwarf the rest."""
    found = []
    for flight in flights:
        values = pick(flight)
        assert values is not None, "one time model flies the whole fleet"
        risen = values[flight.times_s >= _RISEN_S]
        found.append(risen if len(risen) else values)
    return max(1.15 * float(np.quantile(np.concatenate(found), _SHOWN)), 1e-3)


def _height(flight: Motion, dem: Dem) -> Array:
    east, north, up = flight.position_m.T
    return np.asarray(up - dem.height(east, north))


@styled
def flown_timing(facts: FlightFacts) -> Figure:
    """Timing error over planned time on the left, closest approach on the right, per waypoint."""
    figure = new_figure(PAGE_WIDTH_IN, 3.0)
    left, right = figure.subplots(1, 2, sharex=True)
    for index, uav in enumerate(facts.plan.uavs):
        mine = [one for one in facts.passages if one.uav == uav.id]
        style = {**uav_style(index, 3.2), "linewidth": 0.8}
        timed = [one for one in mine if one.visited]
        left.plot(
            [one.planned_s for one in timed],
            [one.late_s for one in timed],
            label=uav.id,
            **style,
        )
        near = [one for one in mine if np.isfinite(one.closest_m)]
        right.plot(
            [one.planned_s for one in near],
            [max(one.closest_m, 1e-2) for one in near],
            **{**style, "linestyle": "none"},
        )
    left.axhline(0.0, color="black", linewidth=0.6)
    low, high = left.get_ylim()
    left.set_ylim(min(low, -_LEAST_S), max(high, _LEAST_S))
    left.set_ylabel("Behind the plan (s)")
    left.set_title("(a) Timing error: above the line is late", loc="left")
    right.axhline(VISITED_M, color="black", linewidth=0.8, linestyle=(0, (5, 1.5)))
    right.annotate(
        f"counts as visited below {VISITED_M:g} m",
        (1.0, VISITED_M),
        xycoords=right.get_yaxis_transform(),
        xytext=(0, 3),
        textcoords="offset points",
        ha="right",
        fontsize=6.5,
    )
    right.set_yscale("log")
    right.set_ylabel("Closest approach (m)")
    right.set_title("(b) Distance to the waypoint", loc="left")
    for axes in (left, right):
        axes.set_xlabel("Planned arrival (s after lift-off)")
        rule(axes)
    figure.legend(loc="outside upper center", ncols=min(len(facts.plan.uavs), 10))
    return figure
