"""Tables of the report."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from jfto.analysis.comparison import OURS, Comparison
from jfto.analysis.export import active_text, paper_ratios, throughput_ratios
from jfto.analysis.flight_spread import Spread
from jfto.analysis.paper import PAPER
from jfto.report.palette import uav_colour
from jfto_msgs_py.plan import Plan


def html_table(
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    ours: int | None = None,
    text_from: int | None = None,
) -> str:
    """HTML table of ready cells; row `ours` is set apart, columns from `text_from` on are prose."""

    def cells(kind: str, row: Sequence[str]) -> str:
        prose = len(row) if text_from is None else text_from
        marks = [' class="text"' if column >= prose else "" for column in range(len(row))]
        return "".join(f"<{kind}{m}>{cell}</{kind}>" for m, cell in zip(marks, row, strict=True))

    head = cells("th", header)
    body = "".join(
        ('<tr class="ours">' if index == ours else "<tr>") + cells("td", row) + "</tr>"
        for index, row in enumerate(rows)
    )
    return (
        f'<div class="scroll"><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def comparison_table(comparison: Comparison, scene: str) -> str:
    """Ours beside the paper's, one row per algorithm."""
    theirs = PAPER.get(scene, {})
    header = ["Algorithm", "Traverses all", "ξ (%)", "Throughput (Mb/s)", "Hops", "Neighbours"]
    rows, ours = [], None
    for index, result in enumerate(comparison.results):
        if result.name == OURS:
            ours = index
        paper = theirs.get(result.name)
        cells = [
            "yes" if result.traverses_all else "no",
            f"{100 * result.linked.connectivity_rate:.1f}",
            f"{result.linked.mean_throughput_mbps:.0f}",
            number(result.linked.hops, 2),
        ]
        if paper is not None:
            beside = [
                "yes" if paper.traverses_all else "no",
                f"{100 * paper.connectivity_rate:.1f}",
                f"{paper.throughput:.0f}",
                "–" if paper.hops is None else number(paper.hops, 2),
            ]
            cells = [
                f'{mine} <span class="theirs">({other})</span>'
                for mine, other in zip(cells, beside, strict=True)
            ]
        degree = result.degree
        spread = f"{degree.min()}–{degree.max()}, mean {degree.mean():.2f}"
        rows.append([result.name, *cells, spread])
    note = '<p class="soft">In brackets: the paper\'s figures.</p>' if theirs else ""
    active = f'<p class="soft">{active_text(comparison)}</p>'
    return html_table(header, rows, ours) + note + _ratio_text(comparison, scene) + active


def fleet_table(plan: Plan, comparison: Comparison) -> str:
    """One row per UAV: what it flies and what it spends."""
    header = [
        "UAV",
        "Waypoints",
        "Length (km)",
        "Last waypoint (s)",
        "Limit (s)",
        "P<sub>max</sub> (dBm)",
        "Energy (J)",
        "Budget (J)",
        "Neighbours",
    ]
    rows = []
    for index, (uav, route) in enumerate(zip(plan.uavs, plan.routes, strict=True)):
        degree = comparison.ours.degree[:, index]
        rows.append(
            [
                swatch(index) + escape(uav.id),
                str(len(route.waypoint_ids)),
                f"{route.length_m / 1000:.2f}",
                f"{route.arrival_s[-1] if route.arrival_s else 0:.0f}",
                f"{uav.t_max_s:.0f}",
                f"{uav.p_max_dbm:.1f}",
                f"{comparison.ours.energy_j[index]:.1f}",
                f"{uav.energy_j:.1f}",
                f"{degree.min()}–{degree.max()}",
            ]
        )
    return html_table(header, rows)


def certificate_table(plan: Plan) -> str:
    """What the independent check found."""
    certificate = plan.certificate
    if certificate is None:
        return "<p>This plan has not been checked.</p>"
    longest = max((route.arrival_s[-1] for route in plan.routes if route.arrival_s), default=0.0)
    floor = np.array(certificate.energy_floor_j)
    budget = np.array([uav.energy_j for uav in plan.uavs])
    slot = number(certificate.worst_margin_slot, 1)
    worst = f"{escape(certificate.worst_margin_uav)}, slot {slot}"
    rows = [
        ["Slot checks of the neighbour rule", f"{certificate.slot_checks}"],
        ["of these violated", f"{certificate.slot_violations}"],
        ["Violations at ten times finer sampling", f"{certificate.fine_violations}"],
        [
            "Least margin on a K<sub>min</sub>-th neighbour at P<sub>max</sub>",
            f"{number(certificate.worst_margin_db, 2)} dB ({worst})",
        ],
        [
            "Least distance between two UAVs",
            f"{number(certificate.worst_separation_m, 1)} m (limit {plan.d_min_m:g} m)",
        ],
        [
            "Length of all routes",
            f"{plan.total_length_m / 1000:.2f} km (limit {plan.length_max_m / 1000:g} km)",
        ],
        ["Last waypoint reached", f"{longest:.0f} s"],
    ]
    if floor.size:
        tightest = int(np.argmax(floor / budget))
        spent = f"{floor[tightest]:.1f} of {budget[tightest]:.1f} J"
        name = escape(plan.uavs[tightest].id)
        rows.append(["Least energy that the topology costs, tightest UAV", f"{spent} ({name})"])
    return html_table(["Check", "Result"], rows)


def spread_table(spread: Sequence[Spread], wind_mps: float) -> str:
    """Arrivals without gates, less the planned ones, one row per UAV."""
    rows = [
        [
            escape(one.uav),
            f"{one.end_s:.1f}",
            " to ".join(f"{value:+.1f}" for value in one.planner_s),
            " to ".join(f"{value:+.1f}" for value in one.wind_s),
        ]
        for one in spread
    ]
    header = [
        "UAV",
        "Last waypoint (s)",
        "Planner without the vehicle's lag (s)",
        f"Wind of {wind_mps:g} m/s from four quarters (s)",
    ]
    return html_table(header, rows)


def swatch(index: int) -> str:
    """A patch of the UAV's colour."""
    return f'<span class="swatch" style="background:{uav_colour(index)}"></span>'


def number(value: float, decimals: int) -> str:
    """A number with its digits, in words where it is not finite."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return f"{value:.{decimals}f}"


def _ratio_text(comparison: Comparison, scene: str) -> str:
    theirs = paper_ratios(scene)
    parts = [
        f"{ratio:.2f} × {name}" + (f" (paper {theirs[name]:.2f})" if name in theirs else "")
        for name, ratio in throughput_ratios(comparison).items()
    ]
    return f"<p>C-TOP's throughput is {', '.join(parts)}.</p>" if parts else ""
