"""What the links and distances could still have lost, over the mission."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from jfto.analysis.facts import FlightFacts
from jfto.analysis.grid import FINER
from jfto.report.figures.style import (
    FLOWN_STYLE,
    PAGE_WIDTH_IN,
    PLANNED_STYLE,
    TROUBLE_COLOUR,
    new_figure,
    styled,
)
from jfto_msgs_py.types import Array

# More to spare than this is as good as any.
_MOST_DB, _MOST_GAPS = 20.0, 6.0


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
        axes.grid(axis="y", linewidth=0.4, color="#dddddd")
    top.plot(desk, planned.margin_db.min(axis=1), label="planned", **PLANNED_STYLE)
    top.plot(fine, _finite(certificate.margin_db), label="as flown", **FLOWN_STYLE)
    top.axhline(0.0, color="black", linewidth=0.8)
    both = np.concatenate([_finite(certificate.margin_db), planned.margin_db.min(axis=1)])
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
