"""The parts of the report that tell of a flight."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from html import escape

from jfto.analysis.facts import FlightFacts
from jfto.analysis.passages import VISITED_M
from jfto.report.flight_tables import (
    certificate_table,
    energy_table,
    events_table,
    exceptions_table,
    network_table,
    timing_table,
)
from jfto.report.tables import number

FLIGHT_CAPTIONS = {
    "flown_map": "Planned flight (dashed) and flown track. Rings: where an exception began.",
    "flown_timing": "Every waypoint: how late it was passed, and how far off.",
    "flown_certificate": "What links and distances could still have lost.",
    "flown_network": "The network as planned and as flown.",
    "flown_events": "What happened to whom. Bars: exceptions. Ticks: waypoints passed.",
}


def flight_head(facts: FlightFacts) -> str:
    """What came of the flight, for the top of the page."""
    return "<h2>As flown</h2>" + _verdict(facts) + _cards(facts) + _notes(facts)


def flight_section(facts: FlightFacts, figures: Mapping[str, str]) -> str:
    """Everything about the flight; `figures` are ready HTML by file stem, empty where missing."""
    return (
        "<h2>Planned and flown</h2>"
        + figures["flown_map"]
        + "<h3>Time and place</h3>"
        + timing_table(facts)
        + figures["flown_timing"]
        + "<h3>Certificate on the flown tracks</h3>"
        + certificate_table(facts)
        + exceptions_table(facts)
        + figures["flown_certificate"]
        + "<h3>Network and energy</h3>"
        + network_table(facts)
        + energy_table(facts)
        + figures["flown_network"]
        + "<h3>Events</h3>"
        + figures["flown_events"]
        + events_table(facts)
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


def _endings_text(facts: FlightFacts) -> str:
    counts = Counter(one.how for one in facts.endings)
    if set(counts) == {"landed"}:
        return "all landed"
    return ", ".join(f"{count} {how}" for how, count in counts.items())
