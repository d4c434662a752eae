"""Neighbours over the mission, and what each UAV spends on transmitting."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jfto.analysis.comparison import Comparison
from jfto.report.figures.style import ALGORITHM_STYLES, PAGE_WIDTH_IN, new_figure, styled
from jfto_msgs_py.plan import Plan


@styled
def degree_and_energy(plan: Plan, comparison: Comparison) -> Figure:
    """Least and mean degree of each slot on the left; energy of each UAV on the right."""
    figure = new_figure(PAGE_WIDTH_IN, 3.1)
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
    _draw_degree(left, plan, comparison)
    _draw_energy(right, plan, comparison)
    handles, labels = left.get_legend_handles_labels()
    budget = Line2D([], [], color="black", linewidth=1.4)
    figure.legend(
        [*handles, budget], [*labels, "energy budget"], loc="outside upper center", ncols=5
    )
    return figure


def _draw_degree(axes: Axes, plan: Plan, comparison: Comparison) -> None:
    slots = np.arange(plan.slots.count + 1)
    axes.axhspan(
        plan.k_min, plan.k_min + plan.delta, color="#0072B2", alpha=0.10, linewidth=0, zorder=0
    )
    for result in comparison.results:
        style = ALGORITHM_STYLES[result.name]
        axes.plot(
            slots,
            result.degree.mean(axis=1),
            color=style["color"],
            linestyle=style["linestyle"],
            label=result.name,
        )
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
    count = len(plan.uavs)
    width = 0.8 / len(comparison.results)
    for order, result in enumerate(comparison.results):
        style = ALGORITHM_STYLES[result.name]
        where = np.arange(count) + (order - (len(comparison.results) - 1) / 2) * width
        axes.bar(where, result.energy_j, width=width * 0.92, color=style["color"])
    for index, uav in enumerate(plan.uavs):
        axes.hlines(uav.energy_j, index - 0.45, index + 0.45, color="black", linewidth=1.2)
    axes.set_xticks(range(count), [uav.id for uav in plan.uavs], rotation=45 if count > 9 else 0)
    axes.set_ylabel("Energy for transmission (J)")
    axes.set_ylim(0, 1.12 * max(uav.energy_j for uav in plan.uavs))
    axes.set_title("(b) Energy", loc="left")
