"""The parts of the report that tell of a flight."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from html import escape

import numpy as np

from jfto.as_flown.facts import FlightFacts
from jfto.as_flown.passages import VISITED_M
from jfto.report.tables import html_table, number, swatch
from jfto_msgs_py.ros.events import ERROR, WARN
from jfto_topology.metrics import average_hops

FLIGHT_CAPTIONS = {
    "flown_map": "Planned flight (dashed) and flown track. Rings: where an exception began.",
    "flown_timing": "Every waypoint: how late it was passed, and how far off.",
    "flown_certificate": "What links and distances could still have lost.",
    "flown_network": "The network as planned and as flown.",
    "flown_events": "What happened to whom. Bars: exceptions. Ticks: waypoints passed.",
}
_EVENTS_SHOWN = 40


def flight_head(facts: FlightFacts) -> str:
    """What came of the flight, for the top of the page."""
    return "<h2>As flown</h2>" + _verdict(facts) + _cards(facts) + _notes(facts)


def flight_section(facts: FlightFacts, figures: Mapping[str, str]) -> str:
    """Everything about the flight; `figures` are ready HTML by file stem, empty where missing."""
    return (
        "<h2>Planned and flown</h2>"
        + figures["flown_map"]
        + "<h3>Time and place</h3>"
        + _timing_table(facts)
        + figures["flown_timing"]
        + "<h3>Certificate on the flown tracks</h3>"
        + _certificate_table(facts)
        + _exceptions_table(facts)
        + figures["flown_certificate"]
        + "<h3>Network and energy</h3>"
        + _network_table(facts)
        + _energy_table(facts)
        + figures["flown_network"]
        + "<h3>Events</h3>"
        + figures["flown_events"]
        + _events_table(facts)
    )


def _verdict(facts: FlightFacts) -> str:
    """What came of the flight, in one box."""
    certificate = facts.certificate
    clean = f"{certificate.clean.sum()} of {len(certificate.clean)} slots clean"
    head, kind = ("✓ Flown as planned.", "") if facts.good else ("✗ Not all as planned.", " bad")
    parts = [
        f"{facts.visited} of {len(facts.passages)} waypoints visited",
        f"{clean} on the flown tracks ({100 * certificate.clean_share:.1f} %)",
        f"{100 * facts.throughput.ratio:.1f} % of the planned throughput",
        _endings_text(facts),
    ]
    return f'<div class="verdict{kind}"><strong>{head}</strong> {escape(", ".join(parts))}.</div>'


def _cards(facts: FlightFacts) -> str:
    """Figures of the flight at a glance."""
    least = min((1 - one.used_j / one.budget_j for one in facts.energy), default=0.0)
    cards = [
        (f"{facts.visited} / {len(facts.passages)}", f"waypoints within {VISITED_M:g} m"),
        (f"{facts.worst_late_s:+.1f} s", "worst timing error"),
        (f"{number(facts.worst_closest_m, 1)} m", "farthest from a waypoint"),
        (f"{number(facts.certificate.worst_margin_db, 1)} dB", "least margin at P<sub>max</sub>"),
        (f"{number(facts.certificate.least_separation_m, 1)} m", "least distance of two UAVs"),
        (f"{100 * least:.0f} %", "energy left, least UAV"),
    ]
    tiles = "".join(
        f'<div class="card"><b>{big}</b><span>{small}</span></div>' for big, small in cards
    )
    return f'<div class="cards">{tiles}</div>'


def _notes(facts: FlightFacts) -> str:
    """Where the facts come from, and what the record lacks."""
    sources = f"Lift-off: {facts.flight.lift_off_source}. Network: {facts.network.source}."
    powers = Counter(steps.source for steps in facts.flight.powers.values())
    words = ", ".join(f"{count} × {source}" for source, count in powers.items())
    notes = "".join(f"<li>{escape(note)}</li>" for note in facts.flight.notes)
    lacking = f"<ul>{notes}</ul>" if notes else ""
    return f'<p class="soft">{escape(sources)} Powers: {escape(words)}.</p>{lacking}'


def _timing_table(facts: FlightFacts) -> str:
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


def _exceptions_table(facts: FlightFacts) -> str:
    """Every exception with its cause, and how often each kind came."""
    found = facts.certificate.exceptions
    if not found:
        return "<p>No exceptions: every constraint was kept at every instant looked at.</p>"
    kinds = Counter(one.kind for one in found)
    words = ", ".join(f"{count} × {kind}" for kind, count in kinds.most_common())
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


def _certificate_table(facts: FlightFacts) -> str:
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
        ["Least height over the terrain, pads included", "", f"{height.min():.1f} m"]
        if height.size
        else ["Least height over the terrain", "", "unknown"],
        [
            "Least distance on the way home, not part of the plan",
            "",
            f"{number(min((one.return_gap_m for one in facts.endings), default=np.inf), 1)} m",
        ],
    ]
    return html_table(["Check", "Planned", "As flown"], rows)


def _network_table(facts: FlightFacts) -> str:
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


def _energy_table(facts: FlightFacts) -> str:
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


def _events_table(facts: FlightFacts) -> str:
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


def _endings_text(facts: FlightFacts) -> str:
    counts = Counter(one.how for one in facts.endings)
    if set(counts) == {"landed"}:
        return "all landed"
    return ", ".join(f"{count} {how}" for how, count in counts.items())
