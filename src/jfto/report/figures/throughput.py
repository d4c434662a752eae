"""Network throughput over the mission."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from jfto.analysis.comparison import Comparison
from jfto.report.figures.style import ALGORITHM_STYLES, PAGE_WIDTH_IN, new_figure, styled
from jfto_msgs_py.plan import Plan


@styled
def throughput_over_slots(plan: Plan, comparison: Comparison) -> Figure:
    """Throughput of every slot for each algorithm, with the instant n_DC."""
    figure = new_figure(PAGE_WIDTH_IN, 2.9)
    axes = figure.add_subplot()
    slots = np.arange(plan.slots.count + 1)
    for result in comparison.results:
        style = ALGORITHM_STYLES[result.name]
        gigabits = result.linked.throughput_bps / 1e9
        label = f"{result.name}, mean {result.linked.mean_throughput_mbps / 1e3:.2f} Gb/s"
        axes.plot(
            slots[1:],
            gigabits[1:],
            color=style["color"],
            linestyle=style["linestyle"],
            linewidth=1.8 if result is comparison.ours else 1.2,
            label=label,
            zorder=3 if result is comparison.ours else 2,
        )
    axes.set_xlim(1, plan.slots.count)
    axes.set_ylim(bottom=0)
    axes.set_xlabel(f"Slot n ({plan.slots.duration_s:.2f} s each)")
    axes.set_ylabel("Network throughput (Gb/s)")
    axes.grid(axis="y", linewidth=0.4, color="#dddddd")
    figure.legend(loc="outside upper center", ncols=4)
    return figure
