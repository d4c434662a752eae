"""The page: everything of a run in one file that works offline."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from importlib import resources
from typing import Any

from jfto.analysis.comparison import Comparison
from jfto.analysis.facts import FlightFacts
from jfto.analysis.flight_spread import Spread, spread_text
from jfto.report.flight_sections import FLIGHT_CAPTIONS, flight_head, flight_section
from jfto.report.scene import FLOWN, scene_data
from jfto.report.tables import (
    certificate_table,
    comparison_table,
    fleet_table,
    number,
    spread_table,
)
from jfto_msgs_py.plan import Plan
from jfto_world.terrain import Dem

# Figures in the order of the page: file stem and caption.
FIGURE_CAPTIONS = {
    "routes": "Routes over the shaded relief. Squares are pads, arrows show the direction.",
    "flight": "Flight of each UAV as timed in the plan. Ticks mark waypoints.",
    "topology": "Links of one slot under the four algorithms.",
    "throughput": "Network throughput of every slot.",
    "degree_energy": "Neighbours over the mission, and energy for transmission per UAV.",
}

# How a plan is flown, by its time model.
FLIGHTS = {
    "constant_speed": "Straight legs at constant speed, without turns or take-off: for comparison "
    "with published results, not for flights.",
    "arducopter": "Waypoint missions, timed as ArduCopter flies them in calm air.",
    "bezier": "Bezier trajectories, streamed by the clock: slots are absolute.",
}


@dataclass(frozen=True)
class ReportContent:
    """What a report shows. `figures` maps file stems to PNG bytes, `coverage` is the coverage
    certificate's figures or None, `versions` maps names of software to versions, `spread` is that
    of arrivals in a wind of `wind_mps`; `flight` is None until the plan was flown.
    """

    title: str
    plan: Plan
    comparison: Comparison
    dem: Dem
    scene: str
    figures: Mapping[str, bytes]
    coverage: Mapping[str, Any] | None
    configuration: str
    versions: Mapping[str, str]
    spread: tuple[Spread, ...] = ()
    wind_mps: float = 0.0
    flight: FlightFacts | None = None


def report_page(content: ReportContent) -> str:
    """The whole report as HTML text."""
    from plotly.offline import get_plotlyjs

    scene = scene_data(content.plan, content.comparison, content.dem, content.flight)
    # "</" inside a script would end it.
    data = json.dumps(scene, separators=(",", ":")).replace("</", "<\\/")
    sections = [
        _summary(content),
        "" if content.flight is None else flight_head(content.flight),
        _scene_section(content),
        _flight_section(content),
        "<h2>Comparison</h2>" + comparison_table(content.comparison, content.scene),
        _notes(content),
        "<h2>Figures</h2>"
        + "".join(_figure(content, stem, FIGURE_CAPTIONS) for stem in FIGURE_CAPTIONS),
        "<h2>Certificate</h2>" + certificate_table(content.plan) + _violations(content.plan),
        _timing_section(content),
        _coverage_section(content),
        "<h2>Fleet</h2>" + fleet_table(content.plan, content.comparison),
        _configuration(content),
    ]
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(content.title)}</title>\n<style>\n{_static('report.css')}</style>\n"
        f"</head>\n<body>\n{''.join(sections)}\n"
        f"<script>{get_plotlyjs()}</script>\n"
        f"<script>const SCENE = {data};\n{_static('scene.js')}</script>\n"
        "</body>\n</html>\n"
    )


def _summary(content: ReportContent) -> str:
    plan, ours = content.plan, content.comparison.ours
    certificate = plan.certificate
    if certificate is not None and certificate.clean:
        kind = ""
        verdict = (
            f"<strong>✓ Verified.</strong> 0 of {certificate.slot_checks} slot checks violated, "
            "also none at ten times finer sampling."
        )
    elif certificate is not None:
        kind = " bad"
        verdict = (
            f"<strong>✗ Infeasible as planned.</strong> {certificate.slot_violations} of "
            f"{certificate.slot_checks} slot checks violated, {len(certificate.violations)} "
            "violations in all. They are listed under Certificate."
        )
    else:
        kind, verdict = " bad", "<strong>Not checked.</strong>"
    cards = [
        (f"{plan.total_length_m / 1000:.2f} km", "length of all routes"),
        (f"{len(plan.waypoints)}", f"waypoints, {len(plan.uavs)} UAVs"),
        (f"{plan.slots.horizon_s:.0f} s", f"{plan.slots.count} slots"),
        (f"{ours.linked.mean_throughput_mbps / 1000:.2f} Gb/s", "mean network throughput"),
        (f"{100 * ours.linked.connectivity_rate:.1f} %", "ξ, one UAV lost"),
        (number(ours.linked.hops, 2), "hops on average"),
    ]
    tiles = "".join(
        f'<div class="card"><b>{big}</b><span>{small}</span></div>' for big, small in cards
    )
    return (
        f"<h1>{escape(content.title)}</h1>"
        f'<p class="soft">{escape(content.dem.description)}</p>'
        f'<div class="verdict{kind}">{verdict}</div><div class="cards">{tiles}</div>'
    )


def _scene_section(content: ReportContent) -> str:
    last = content.plan.slots.count
    options = "".join(
        f"<option{' selected' if result is content.comparison.ours else ''}>{result.name}</option>"
        for result in content.comparison.results
    )
    if content.flight is not None:
        options = options.replace(" selected", "")
        options = f"<option selected>{FLOWN}</option>" + options
    first = min(content.comparison.n_dc, last)
    return (
        "<h2>Flight and links</h2>"
        '<div class="controls"><button id="play" type="button">Play</button>'
        f'<input id="slot" type="range" min="0" max="{last}" value="{first}" aria-label="slot">'
        f'<label>Algorithm <select id="algorithm">{options}</select></label></div>'
        '<p id="slot-facts"></p><div id="scene"></div>'
        '<p class="soft">Drag to turn, scroll to zoom, click a name to hide it. The margin of a '
        "link is the received power over the sensitivity in its weaker direction.</p>"
        "<noscript><p>The three-dimensional view needs JavaScript.</p></noscript>"
    )


def _flight_section(content: ReportContent) -> str:
    if content.flight is None:
        return ""
    stems = FLIGHT_CAPTIONS
    return flight_section(content.flight, {stem: _figure(content, stem, stems) for stem in stems})


def _notes(content: ReportContent) -> str:
    notes = "".join(f"<li>{escape(note)}</li>" for note in content.comparison.notes)
    return f"<h3>C-TOP could not keep</h3><ul>{notes}</ul>" if notes else ""


def _figure(content: ReportContent, stem: str, captions: Mapping[str, str]) -> str:
    if stem not in content.figures:
        return ""
    data = base64.b64encode(content.figures[stem]).decode()
    caption = captions[stem]
    return (
        f'<figure><img alt="{escape(caption)}" src="data:image/png;base64,{data}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def _violations(plan: Plan) -> str:
    if plan.certificate is None or not plan.certificate.violations:
        return ""
    shown = plan.certificate.violations[:200]
    items = "".join(f"<li>{escape(violation.message)}</li>" for violation in shown)
    more = len(plan.certificate.violations) - len(shown)
    rest = f"<p>and {more} more, listed in the plan file.</p>" if more else ""
    return f"<h3>Violations</h3><ul>{items}</ul>{rest}"


def _timing_section(content: ReportContent) -> str:
    flight = FLIGHTS.get(content.plan.time_model, content.plan.time_model)
    text = spread_text(content.spread, content.wind_mps)
    table = spread_table(content.spread, content.wind_mps) if content.spread else ""
    return f"<h2>Timing</h2><p>{escape(flight)} {escape(text)}</p>{table}"


def _coverage_section(content: ReportContent) -> str:
    proof = content.coverage
    if proof is None:
        return ""
    changed = [note for note in proof["notes"] if note["action"] != "added"]
    width, height = proof["footprint_m"]
    text = (
        f"<p>{100 * proof['seen_once']:.2f} % of the area is seen by at least one image and "
        f"{100 * proof['seen_twice']:.1f} % by two or more, found by casting rays against the "
        f"terrain. Ground resolution {proof['gsd_mean_cm']:.2f} ± {proof['gsd_std_cm']:.2f} cm/px; "
        f"incidence {proof['incidence_mean_deg']:.0f}° on average. One image covers "
        f"{width:.0f} × {height:.0f} m at {proof['distance_m']:.0f} m.</p>"
    )
    items = "".join(
        f"<li>{escape(note['action'])}"
        + (f" waypoint {note['waypoint']}" if note["waypoint"] is not None else "")
        + f": {escape(note['reason'])}</li>"
        for note in changed
    )
    moved = (
        f"<details><summary>{len(changed)} waypoints moved or dropped</summary>"
        f"<ul>{items}</ul></details>"
    )
    return f"<h2>Coverage</h2>{text}{moved if changed else ''}"


def _configuration(content: ReportContent) -> str:
    versions = ", ".join(f"{name} {version}" for name, version in content.versions.items())
    plan = content.plan
    return (
        "<h2>Configuration</h2>"
        f"<p>Seed {plan.seed}. Scenario hash <code>{plan.scenario_hash[:16]}</code>. "
        f"Origin {plan.origin.lat_deg:.6f}°, {plan.origin.lon_deg:.6f}°, "
        f"{plan.origin.alt_m:.1f} m.</p>"
        f'<p class="soft">{escape(versions)}</p>'
        f"<details><summary>All scenario keys</summary><pre>{escape(content.configuration)}</pre>"
        "</details>"
    )


def _static(name: str) -> str:
    return (resources.files("jfto.report") / "static" / name).read_text(encoding="utf-8")
