"""Throughput, neighbours and energy, planned and as flown."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jfto.analysis.facts import FlightFacts
from jfto.report.figures.style import FLOWN_STYLE, PAGE_WIDTH_IN, PLANNED_STYLE, new_figure, styled


@styled
def flown_network(facts: FlightFacts) -> Figure:
    """Throughput per slot above, degree and energy below."""
    figure = new_figure(PAGE_WIDTH_IN, 4.6)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.1, 1))
    top = figure.add_subplot(grid[0, :])
    _throughput(top, facts)
    _degree(figure.add_subplot(grid[1, 0]), facts)
    _energy(figure.add_subplot(grid[1, 1]), facts)
    handles, labels = top.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2)
    return figure


def _throughput(axes: Axes, facts: FlightFacts) -> None:
    planned = facts.planned.linked.throughput_bps / 1e9
    got = facts.network.throughput_bps / 1e9
    axes.plot(
        np.arange(1, len(planned)),
        planned[1:],
        label=f"planned, mean {facts.throughput.planned_mbps / 1e3:.2f} Gb/s",
        **PLANNED_STYLE,
    )
    axes.plot(
        np.arange(1, len(got)),
        got[1:],
        label=f"as flown, mean {facts.throughput.achieved_mbps / 1e3:.2f} Gb/s",
        **FLOWN_STYLE,
    )
    axes.set_xlim(0, max(len(planned), len(got)) - 1)
    axes.set_ylim(bottom=0)
    axes.set_xlabel(f"Slot n ({facts.plan.slots.duration_s:.2f} s each)")
    axes.set_ylabel("Throughput (Gb/s)")
    axes.grid(axis="y", linewidth=0.4, color="#dddddd")
    axes.set_title("(a) Network throughput", loc="left")


def _degree(axes: Axes, facts: FlightFacts) -> None:
    for degree, style in (
        (facts.planned.linked.links.sum(axis=2), PLANNED_STYLE),
        (facts.network.degree, FLOWN_STYLE),
    ):
        slots = np.arange(len(degree))
        axes.plot(slots, degree.mean(axis=1), **style)
        axes.plot(slots, degree.min(axis=1), **{**style, "linewidth": 0.7})
    k_min = facts.plan.k_min
    axes.axhline(k_min, color="black", linewidth=0.6)
    axes.text(
        0.99, k_min - 0.1, f"$K_{{min}}$ = {k_min}", transform=axes.get_yaxis_transform(),
        ha="right", va="top", fontsize=6.5,
    )  # fmt: skip
    axes.set_ylim(0, len(facts.plan.uavs) - 0.5)
    axes.set_xlim(left=0)
    axes.set_xlabel("Slot n")
    axes.set_ylabel("Neighbours")
    axes.set_title("(b) Linked pairs: mean, and thin the least", loc="left")


def _energy(axes: Axes, facts: FlightFacts) -> None:
    where = np.arange(len(facts.energy))
    for shift, values, style in (
        (-0.2, [one.planned_j for one in facts.energy], PLANNED_STYLE),
        (0.2, [one.used_j for one in facts.energy], FLOWN_STYLE),
    ):
        axes.bar(where + shift, values, width=0.37, color=style["color"])
    for index, one in enumerate(facts.energy):
        axes.hlines(one.budget_j, index - 0.45, index + 0.45, color="black", linewidth=1.2)
    axes.set_xticks(where, [one.uav for one in facts.energy], rotation=45 if len(where) > 9 else 0)
    axes.set_ylabel("Transmitting (J)")
    axes.set_title("(c) Energy; the bar above is the budget", loc="left")
