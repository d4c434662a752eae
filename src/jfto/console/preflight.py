"""The page of checks before a flight, as a table: worst first, each with its cure, in full."""

from __future__ import annotations

from rich.table import Table
from rich.text import Text

from jfto.console.console import BAD, GOOD, WARNING, Console
from jfto_mavlink.preflight.page import AMBER, GREEN, RED, Preflight

_STYLES = {GREEN: "green", AMBER: "yellow", RED: "bold red"}
_MARKS = {GREEN: GOOD, AMBER: WARNING, RED: BAD}


def show_page(console: Console, page: Preflight) -> None:
    """The table, and what it comes to."""
    console.table(preflight_table(page))
    console.line(page.verdict, _MARKS[page.level])


def preflight_table(page: Preflight) -> Table:
    """A row per finding; vehicles of which the same is said share one."""
    table = Table(title="Preflight", title_justify="left", expand=True)
    for heading, width in (("", 6), ("What", 10), ("Who", 4)):
        table.add_column(heading, min_width=width, max_width=24, overflow="fold")
    table.add_column("Found, and → the cure", ratio=1, overflow="fold")
    rows = page.rows()
    for number, (finding, who) in enumerate(rows):
        last = number + 1 == len(rows) or rows[number + 1][0].level != finding.level
        said = f"{finding.text}\n→ {finding.cure}" if finding.cure else finding.text
        cells = (finding.topic, ", ".join(who), said)
        table.add_row(
            Text(finding.sign, _STYLES[finding.level]), *map(Text, cells), end_section=last
        )
    return table
