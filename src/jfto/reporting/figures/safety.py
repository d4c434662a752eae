"""What links and distances could still have lost in a flight, and what happened to whom."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from jfto.analysis.facts import FlightFacts
from jfto.analysis.grid import FINER
from jfto.reporting.figures.style import (
    FLOWN_STYLE,
    PAGE_WIDTH_IN,
    PLANNED_STYLE,
    TROUBLE_COLOUR,
    new_figure,
    rule,
    styled,
)
from jfto.reporting.palette import uav_colour
from jfto_msgs_py.records.event import grade
from jfto_msgs_py.types import Array

# More to spare than this is as good as any.
_MOST_DB, _MOST_GAPS = 20.0, 6.0
_MARKS = {
    "note": ("o", "#777777", 4),
    "warning": ("^", "#E69F00", 6),
    "error": ("X", TROUBLE_COLOUR, 7),
}
_ROW_IN = 0.24
_MOST_LABELS = 14


@styled
def flown_certificate(facts: FlightFacts) -> Figure:
    """Margin of the K_min-th neighbour at P_max, and least distance; slots with faults marked."""
    plan, certificate = facts.plan, facts.certificate
    planned = facts.desk.instants
    figure = new_figure(PAGE_WIDTH_IN, 3.8)
    top, bottom = figure.subplots(2, 1, sharex=True)
    fine = np.arange(len(facts.grid.times_s)) / FINER
    desk = np.arange(len(planned.margin_db)) / FINER
    for axes in (top, bottom):
        _shade(axes, ~certificate.clean)
        rule(axes)
    wanted, flown = _finite(planned.margin_db.min(axis=1)), _finite(certificate.margin_db)
    top.plot(desk, wanted, label="planned", **PLANNED_STYLE)
    top.plot(fine, flown, label="as flown", **FLOWN_STYLE)
    top.axhline(0.0, color="black", linewidth=0.8)
    both = np.concatenate([flown, wanted])
    low, high = float(min(both.min(), 0.0)), float(np.quantile(both, 0.9))
    top.set_ylim(max(low - 0.5, -_MOST_DB), min(high + 1.0, _MOST_DB))
    top.set_ylabel("To spare (dB)")
    top.set_title("(a) Link to the $K_{min}$-th neighbour at $P_{max}$, least UAV", loc="left")
    bottom.plot(desk, planned.distance.min(axis=1), **PLANNED_STYLE)
    bottom.plot(fine, _finite(certificate.separation_m), **FLOWN_STYLE)
    bottom.axhline(plan.d_min_m, color="black", linewidth=0.8)
    most = max(_MOST_GAPS * plan.d_min_m, 1.5 * float(planned.distance.min()))
    bottom.set_ylim(0, most)
    bottom.set_ylabel("Distance (m)")
    bottom.set_xlabel("Slot n")
    title = f"(b) Least distance between two UAVs; $d_{{min}}$ is {plan.d_min_m:g} m"
    bottom.set_title(title, loc="left")
    bottom.set_xlim(0, max(fine[-1], desk[-1]))
    handles, labels = top.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


def _shade(axes: Axes, faulty: NDArray[np.bool_]) -> None:
    label = "slot with an exception"
    for slot in np.flatnonzero(faulty).tolist():
        axes.axvspan(
            slot, slot + 1, color=TROUBLE_COLOUR, alpha=0.25, linewidth=0, zorder=0, label=label
        )
        label = ""


def _finite(values: Array) -> Array:
    return np.nan_to_num(values, posinf=1e3, neginf=-1e3)


@styled
def flown_events(facts: FlightFacts) -> Figure:
    """A row per UAV and one for the fleet: flight, waypoints, events and exceptions over time."""
    ids = facts.flight.uav_ids
    rows = {uav: len(ids) - index for index, uav in enumerate(ids)} | {"": 0}
    figure = new_figure(PAGE_WIDTH_IN, _ROW_IN * (len(ids) + 1) + 1.3)
    axes = figure.add_subplot()
    for index, uav in enumerate(ids):
        track = facts.flight.tracks[uav]
        if track.times_s.size:
            axes.hlines(
                rows[uav], max(track.times_s[0], 0.0), track.times_s[-1],
                color=uav_colour(index), linewidth=2.5, alpha=0.35,
            )  # fmt: skip
        mine = [one for one in facts.passages if one.uav == uav and one.visited]
        reached = [one.reached_s for one in mine if one.reached_s is not None]
        axes.plot(
            reached, np.full(len(reached), rows[uav]), "|", color=uav_colour(index), markersize=6
        )
    for one in facts.certificate.exceptions:
        begin = one.time_s
        length = max((one.last_slot - one.first_slot) * facts.plan.slots.duration_s, 0.5)
        for uav in one.uav.split("+"):
            axes.broken_barh(
                [(begin, length)], (rows.get(uav, 0) - 0.38, 0.76), color=TROUBLE_COLOUR, alpha=0.3
            )
    _events(axes, facts, rows)
    axes.set_yticks(list(rows.values()), [uav or "fleet" for uav in rows])
    axes.set_ylim(-0.7, len(ids) + 0.7)
    axes.set_xlim(left=min(0.0, _first_s(facts)))
    axes.set_xlabel("Time after lift-off (s)")
    axes.axvline(facts.end_s, color="black", linewidth=0.6, linestyle=(0, (5, 1.5)))
    axes.annotate(
        "last waypoint", (facts.end_s, 1.0), xycoords=("data", "axes fraction"), xytext=(2, 2),
        textcoords="offset points", fontsize=6.5, va="bottom", annotation_clip=False,
    )  # fmt: skip
    handles = [
        axes.plot([], [], mark, color=colour, markersize=size, linestyle="none", label=word)[0]
        for word, (mark, colour, size) in _MARKS.items()
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=3)
    return figure


def _first_s(facts: FlightFacts) -> float:
    return min((facts.flight.seconds(event.stamp_ns) for event in facts.flight.events), default=0.0)


def _events(axes: Axes, facts: FlightFacts, rows: dict[str, int]) -> None:
    """Markers, the graver over the others, and the kinds of the gravest in words."""
    graded = [(grade(event.level), event) for event in facts.flight.events]
    for word, (mark, colour, size) in _MARKS.items():
        these = [event for level, event in graded if level == word]
        axes.plot(
            [facts.flight.seconds(event.stamp_ns) for event in these],
            [rows.get(event.uav_id, 0) for event in these],
            mark, color=colour, markersize=size, linestyle="none", markeredgecolor="white",
            markeredgewidth=0.5, zorder=5,
        )  # fmt: skip
    named = [event for level, event in graded if level != "note"][:_MOST_LABELS]
    for event in named:
        axes.annotate(
            event.kind.replace("_", " "),
            (facts.flight.seconds(event.stamp_ns), rows.get(event.uav_id, 0)),
            xytext=(5, 3), textcoords="offset points", fontsize=6, zorder=6,
        )  # fmt: skip
