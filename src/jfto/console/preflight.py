"""The page of checks before a flight, as a table: worst first, each with its cure, in full."""

from __future__ import annotations

from rich.table import Table
from rich.text import Text

from jfto.console.console import BAD, GOOD, WARNING
from jfto_mavlink.preflight.page import AMBER, GREEN, LEVELS, RED, TOPICS, Finding, Preflight

# Colour never says it alone.
SIGNS = {GREEN: ("✓ fine", "green"), AMBER: ("! look", "yellow"), RED: ("✗ stop", "bold red")}
WAITING = ("… wait", "yellow")
MARKS = {GREEN: GOOD, AMBER: WARNING, RED: BAD}
VERDICTS = {
    GREEN: "Preflight: all fine.",
    AMBER: "Preflight: nothing speaks against a start; look at what is marked !.",
    RED: "Preflight: not to be flown like this; see what is marked ✗.",
}


def preflight_table(page: Preflight) -> Table:
    """A row per finding; vehicles of which the same is said share one."""
    table = Table(title="Preflight", title_justify="left", expand=True)
    for heading, width in (("", 6), ("What", 10), ("Who", 4)):
        table.add_column(heading, min_width=width, max_width=24, overflow="fold")
    table.add_column("Found, and → the cure", ratio=1, overflow="fold")
    rows = rows_of(page)
    for number, (finding, who) in enumerate(rows):
        sign, style = WAITING if finding.waits else SIGNS[finding.level]
        last = number + 1 == len(rows) or rows[number + 1][0].level != finding.level
        said = f"{finding.text}\n→ {finding.cure}" if finding.cure else finding.text
        cells = (finding.topic, ", ".join(who), said)
        table.add_row(Text(sign, style), *map(Text, cells), end_section=last)
    return table


def rows_of(page: Preflight) -> list[tuple[Finding, tuple[str, ...]]]:
    """Each finding with the vehicles that have it ("all"), the worst first, else as TOPICS."""
    who: dict[Finding, list[str]] = {}
    for vehicle in page.vehicles:
        for finding in vehicle.findings:
            who.setdefault(finding, []).append(vehicle.uav)
    everybody = [vehicle.uav for vehicle in page.vehicles]
    order = list(TOPICS)
    found = sorted(who, key=lambda f: (-LEVELS.index(f.level), order.index(f.topic)))
    shared = len(everybody) > 1
    return [(f, ("all",) if shared and who[f] == everybody else tuple(who[f])) for f in found]
