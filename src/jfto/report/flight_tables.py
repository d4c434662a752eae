"""Tables of a flight."""

from __future__ import annotations

from collections import Counter
from html import escape

import numpy as np

from jfto.analysis.facts import FlightFacts
from jfto.report.tables import html_table, number, swatch
from jfto_msgs_py.ros.events import ERROR, WARN
from jfto_topology.metrics import average_hops

_EVENTS_SHOWN = 40
# Kinds of exceptions in words.
_KINDS = {
    "neighbours": "too few neighbours",
    "connected": "fleet in parts",
    "separation": "too close",
    "height": "too low",
    "energy": "energy overdrawn",
    "seen": "not heard for a while",
    "lost": "lost",
}


def timing_table(facts: FlightFacts) -> str:
    """One row per UAV on its waypoints, and every waypoint below, folded."""
    rows = []
    for index, uav in enumerate(facts.plan.uavs):
        mine = [one for one in facts.passages if one.uav == uav.id]
        late = np.array([one.late_s for one in mine if one.visited and one.late_s is not None])
        closest = [one.closest_m for one in mine]
        rows.append(
            [
                swatch(index) + escape(uav.id),
                f"{sum(one.visited for one in mine)} of {len(mine)}",
                f"{late.mean():+.2f}" if late.size else "–",
                f"{late[np.argmax(np.abs(late))]:+.2f}" if late.size else "–",
                number(float(np.median(closest)), 2) if closest else "–",
                number(max(closest), 2) if closest else "–",
                escape(facts.endings[index].how),
            ]
        )
    header = [
        "UAV",
        "Visited",
        "Mean error (s)",
        "Worst error (s)",
        "Median distance (m)",
        "Worst distance (m)",
        "End",
    ]
    each = [
        [
            escape(one.uav),
            str(one.waypoint_id),
            f"{one.planned_s:.1f}",
            "–" if one.reached_s is None else f"{one.reached_s:.1f}",
            "–" if one.late_s is None else f"{one.late_s:+.2f}",
            number(one.closest_m, 2),
            "" if one.visited else "missed",
        ]
        for one in facts.passages
    ]
    names = ["UAV", "Waypoint", "Planned (s)", "Passed (s)", "Error (s)", "Distance (m)", ""]
    return (
        html_table(header, rows) + "<details><summary>Every waypoint</summary>"
        f"{html_table(names, each)}</details>"
    )


def exceptions_table(facts: FlightFacts) -> str:
    """Every exception with its cause, and how often each kind came."""
    found = facts.certificate.exceptions
    if not found:
        return "<p>No exceptions: every constraint was kept at every instant looked at.</p>"
    kinds = Counter(one.kind for one in found)
    words = ", ".join(f"{count} × {_KINDS[kind]}" for kind, count in kinds.most_common())
    rows = [
        [
            f"{one.first_slot:g}"
            + ("" if one.last_slot == one.first_slot else f" to {one.last_slot:g}"),
            escape(one.uav or "fleet"),
            "–" if one.margin_db is None else number(one.margin_db, 2),
            escape(one.message),
            escape(one.cause or "no cause on record"),
        ]
        for one in found
    ]
    header = ["Slots", "UAV", "Margin (dB)", "What", "Why"]
    return f"<p>{escape(words)}.</p>" + html_table(header, rows, text_from=3)


def certificate_table(facts: FlightFacts) -> str:
    """The flown tracks beside the plan."""
    certificate, plan = facts.certificate, facts.plan
    planned = plan.certificate
    height = certificate.height_m[np.isfinite(certificate.height_m)]
    worst = f"{escape(certificate.worst_margin_uav)}, slot {certificate.worst_margin_slot:.1f}"
    rows = [
        [
            "Slots without any violation",
            "",
            f"{certificate.clean.sum()} of {certificate.clean.size}",
        ],
        [
            "Slot checks of the neighbour rule violated",
            "" if planned is None else f"{planned.slot_violations} of {planned.slot_checks}",
            f"{certificate.slot_violations} of {certificate.slot_checks}",
        ],
        [
            "Least margin on a K<sub>min</sub>-th neighbour at P<sub>max</sub>",
            "" if planned is None else f"{number(planned.worst_margin_db, 2)} dB",
            f"{number(certificate.worst_margin_db, 2)} dB ({worst})",
        ],
        [
            f"Least distance between two UAVs (limit {plan.d_min_m:g} m)",
            "" if planned is None else f"{number(planned.worst_separation_m, 1)} m",
            f"{number(certificate.least_separation_m, 1)} m",
        ],
        [
            "Least height over the terrain, pads included",
            "",
            f"{round(height.min(), 1) + 0.0:.1f} m",
        ]
        if height.size
        else ["Least height over the terrain", "", "unknown"],
        [
            "Least distance on the way home, not part of the plan",
            "",
            f"{number(min((one.return_gap_m for one in facts.endings), default=np.inf), 1)} m",
        ],
    ]
    return html_table(["Check", "Planned", "As flown"], rows)


def network_table(facts: FlightFacts) -> str:
    """Throughput, ξ, hops and neighbours, planned and as flown."""
    planned, network = facts.planned.linked, facts.network
    where_linked = ""
    if not np.isfinite(network.hops):
        where_linked = f" ({number(network.linked_hops, 2)} where linked)"
    before, after = facts.planned.linked.links.sum(axis=2), network.degree
    rows = [
        [
            "Throughput, mean over slots (Mb/s)",
            f"{facts.throughput.planned_mbps:.0f}",
            f"{facts.throughput.achieved_mbps:.0f} ({100 * facts.throughput.ratio:.1f} %)",
        ],
        [
            "ξ (%)",
            f"{100 * planned.connectivity_rate:.1f}",
            f"{100 * network.connectivity_rate:.1f}",
        ],
        [
            "Hops on average",
            number(average_hops(planned.links), 2),
            number(network.hops, 2) + where_linked,
        ],
        [
            "Neighbours, least to most",
            f"{before.min()} to {before.max()}, mean {before.mean():.2f}",
            f"{after.min()} to {after.max()}, mean {after.mean():.2f}",
        ],
    ]
    return html_table(["", "Planned", "As flown"], rows)


def energy_table(facts: FlightFacts) -> str:
    """What transmitting cost each UAV."""
    rows = [
        [
            swatch(index) + escape(one.uav),
            f"{one.budget_j:.1f}",
            f"{one.planned_j:.1f}",
            f"{one.used_j:.1f}",
            f"{100 * one.used_j / one.budget_j:.1f} %",
            "overdrawn" if one.overdraft_j > 0 else "",
        ]
        for index, one in enumerate(facts.energy)
    ]
    header = ["UAV", "Budget (J)", "Planned (J)", "Used (J)", "of the budget", ""]
    source = facts.energy[0].source if facts.energy else ""
    return html_table(header, rows) + f'<p class="soft">Used: {escape(source)}.</p>'


def events_table(facts: FlightFacts) -> str:
    """Warnings and errors in full, everything else folded; then spells in the diagnostics."""
    flight = facts.flight
    grave = [event for event in flight.events if event.level >= WARN]
    rows = [
        [
            f"{flight.seconds(event.stamp_ns):.1f}",
            "error" if event.level >= ERROR else "warning" if event.level >= WARN else "note",
            escape(event.uav_id or "fleet"),
            escape(event.kind),
            escape(event.text),
        ]
        for event in flight.events
    ]
    header = ["Time (s)", "", "UAV", "Kind", "What happened and what was done"]
    text = f"<p>{len(flight.events)} events, {len(grave)} of them warnings or errors.</p>"
    if rows:
        table = html_table(header, rows, text_from=1)
        folded = len(rows) > _EVENTS_SHOWN
        text += f"<details><summary>All events</summary>{table}</details>" if folded else table
    if flight.troubles:
        spells = [
            [
                f"{one.from_s:.0f} to {one.to_s:.0f}",
                escape(one.node),
                escape(one.uav or "–"),
                escape(one.text),
            ]
            for one in flight.troubles
        ]
        table = html_table(["Time (s)", "Node", "UAV", "What it said"], spells, text_from=1)
        text += (
            f"<details><summary>{len(spells)} spells of trouble in the nodes' diagnostics"
            f"</summary>{table}</details>"
        )
    return text
