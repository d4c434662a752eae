"""What the network carries, who is neighbour of how many, and what transmitting costs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from jfto.analysis.comparison import Comparison
from jfto.analysis.facts import FlightFacts
from jfto.reporting.figures.style import (
    ALGORITHM_STYLES,
    FLOWN_STYLE,
    PAGE_WIDTH_IN,
    PLANNED_STYLE,
    new_figure,
    rule,
    styled,
)
from jfto_msgs_py.records.plan import Plan


@styled
def throughput_over_slots(plan: Plan, comparison: Comparison) -> Figure:
    """Throughput of every slot for each algorithm."""
    figure = new_figure(PAGE_WIDTH_IN, 2.9)
    axes = figure.add_subplot()
    slots = np.arange(plan.slots.count + 1)
    for result in comparison.results:
        gigabits = result.linked.throughput_bps / 1e9
        label = f"{result.name}, mean {result.linked.mean_throughput_mbps / 1e3:.2f} Gb/s"
        axes.plot(
            slots[1:],
            gigabits[1:],
            **ALGORITHM_STYLES[result.name],
            linewidth=1.8 if result is comparison.ours else 1.2,
            label=label,
            zorder=3 if result is comparison.ours else 2,
        )
    axes.set_xlim(1, plan.slots.count)
    axes.set_ylim(bottom=0)
    axes.set_xlabel(f"Slot n ({plan.slots.duration_s:.2f} s each)")
    axes.set_ylabel("Network throughput (Gb/s)")
    rule(axes)
    figure.legend(loc="outside upper center", ncols=3)
    return figure


@styled
def degree_and_energy(plan: Plan, comparison: Comparison) -> Figure:
    """Mean degree of each slot on the left; energy of each UAV on the right."""
    figure = new_figure(PAGE_WIDTH_IN, 3.1)
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
    _draw_degree(left, plan, comparison)
    _draw_energy(right, plan, comparison)
    handles, labels = left.get_legend_handles_labels()
    budget = Line2D([], [], color="black", linewidth=1.4)
    figure.legend(
        [*handles, budget], [*labels, "energy budget"], loc="outside upper center", ncols=4
    )
    return figure


def _draw_degree(axes: Axes, plan: Plan, comparison: Comparison) -> None:
    slots = np.arange(plan.slots.count + 1)
    axes.axhspan(
        plan.k_min, plan.k_min + plan.delta, color="#0072B2", alpha=0.10, linewidth=0, zorder=0
    )
    for result in comparison.results:
        degree = result.degree.mean(axis=1)
        axes.plot(slots, degree, **ALGORITHM_STYLES[result.name], label=result.name)
    axes.text(
        0.99,
        plan.k_min + plan.delta + 0.08,
        f"$K_{{min}}$ to $K_{{min}}+δ$: {plan.k_min} to {plan.k_min + plan.delta}",
        transform=axes.get_yaxis_transform(),
        ha="right",
        va="bottom",
        fontsize=6.5,
        color="#0072B2",
    )
    axes.set_xlim(0, plan.slots.count)
    axes.set_ylim(0, max(len(plan.uavs) - 0.5, plan.k_min + plan.delta + 0.6))
    axes.set_xlabel("Slot n")
    axes.set_ylabel("Neighbours, mean over UAVs")
    axes.set_title("(a) Degree", loc="left")


def _draw_energy(axes: Axes, plan: Plan, comparison: Comparison) -> None:
    bars = [(ALGORITHM_STYLES[one.name]["color"], one.energy_j) for one in comparison.results]
    _bars(axes, plan, bars)
    axes.set_ylabel("Energy for transmission (J)")
    axes.set_ylim(0, 1.12 * max(uav.energy_j for uav in plan.uavs))
    axes.set_title("(b) Energy", loc="left")


def _bars(axes: Axes, plan: Plan, bars: Sequence[tuple[str, ArrayLike]]) -> None:
    """For each UAV its bars in J, by colour, under a line at its budget."""
    count, width = len(plan.uavs), 0.8 / len(bars)
    for order, (colour, energy_j) in enumerate(bars):
        where = np.arange(count) + (order - (len(bars) - 1) / 2) * width
        axes.bar(where, energy_j, width=width * 0.92, color=colour)
    for index, uav in enumerate(plan.uavs):
        axes.hlines(uav.energy_j, index - 0.45, index + 0.45, color="black", linewidth=1.2)
    axes.set_xticks(range(count), [uav.id for uav in plan.uavs], rotation=45 if count > 9 else 0)


@styled
def flown_network(facts: FlightFacts) -> Figure:
    """Throughput per slot above, degree and energy below."""
    figure = new_figure(PAGE_WIDTH_IN, 4.6)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.1, 1))
    top = figure.add_subplot(grid[0, :])
    _draw_flown_throughput(top, facts)
    _draw_flown_degree(figure.add_subplot(grid[1, 0]), facts)
    _draw_flown_energy(figure.add_subplot(grid[1, 1]), facts)
    handles, labels = top.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2)
    return figure


def _draw_flown_throughput(axes: Axes, facts: FlightFacts) -> None:
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
    rule(axes)
    axes.set_title("(a) Network throughput", loc="left")


def _draw_flown_degree(axes: Axes, facts: FlightFacts) -> None:
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


def _draw_flown_energy(axes: Axes, facts: FlightFacts) -> None:
    planned, used = zip(*[(one.planned_j, one.used_j) for one in facts.energy], strict=True)
    _bars(axes, facts.plan, [(PLANNED_STYLE["color"], planned), (FLOWN_STYLE["color"], used)])
    axes.set_ylabel("Transmitting (J)")
    axes.set_title("(c) Energy; the bar above is the budget", loc="left")
