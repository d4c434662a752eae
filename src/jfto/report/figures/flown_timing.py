"""How late and how far off each waypoint was passed."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from jfto.analysis.facts import FlightFacts
from jfto.analysis.passages import VISITED_M
from jfto.report.figures.style import (
    PAGE_WIDTH_IN,
    new_figure,
    styled,
    uav_dash,
    uav_marker,
    uav_marker_size,
)
from jfto.report.palette import uav_colour

_LEAST_S = 1.0


@styled
def flown_timing(facts: FlightFacts) -> Figure:
    """Timing error over planned time on the left, closest approach on the right, per waypoint."""
    figure = new_figure(PAGE_WIDTH_IN, 3.0)
    left, right = figure.subplots(1, 2, sharex=True)
    for index, uav in enumerate(facts.plan.uavs):
        mine = [one for one in facts.passages if one.uav == uav.id]
        style = {
            "color": uav_colour(index),
            "linestyle": uav_dash(index),
            "linewidth": 0.8,
            "marker": uav_marker(index),
            "markersize": uav_marker_size(index, 3.2),
        }
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
    # What is of no account should look so.
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
        axes.grid(axis="y", linewidth=0.4, color="#dddddd")
    figure.legend(loc="outside upper center", ncols=min(len(facts.plan.uavs), 10))
    return figure
