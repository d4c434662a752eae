"""Speed, acceleration, jerk and height over terrain of each UAV's flight."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from jfto.analysis.motion import Flown, flown
from jfto.report.figures.style import PAGE_WIDTH_IN, new_figure, styled
from jfto.report.palette import uav_colour
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.types import Array
from jfto_world.terrain import Dem

_ROW_IN = 0.78
# Share of all values that an axis shows, and when a take-off's jolts are over.
_SHOWN, _RISEN_S = 0.998, 10.0


@styled
def flight_profiles(plan: Plan, dem: Dem) -> Figure:
    """One row per UAV, one column per quantity; ticks below a curve mark waypoints passed."""
    flights = flown(plan)
    columns: list[tuple[str, Callable[[Flown], Array | None]]] = [
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
            axes.grid(axis="y", linewidth=0.4, color="#dddddd")
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


def _top(flights: tuple[Flown, ...], pick: Callable[[Flown], Array | None]) -> float:
    """Top of an axis: a take-off begins with a jolt in the model, which would dwarf the rest."""
    found = []
    for flight in flights:
        values = pick(flight)
        assert values is not None, "one time model flies the whole fleet"
        risen = values[flight.times_s >= _RISEN_S]
        found.append(risen if len(risen) else values)
    return max(1.15 * float(np.quantile(np.concatenate(found), _SHOWN)), 1e-3)


def _height(flight: Flown, dem: Dem) -> Array:
    east, north, up = flight.position_m.T
    return np.asarray(up - dem.height(east, north))
