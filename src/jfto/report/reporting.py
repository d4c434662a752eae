"""Last stage: the report of a run directory."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jfto.analysis.comparison import Comparison
from jfto.analysis.facts import FlightFacts
from jfto.analysis.flight_spread import flight_spread
from jfto.console.progress import Watcher
from jfto.pipeline.directory import COVERAGE_NAME, FIGURES, REPORT_NAME, SCENARIO_NAME
from jfto.report import ReportContent, report_page
from jfto.versions import versions
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.read_text import read_text
from jfto_msgs_py.write_file import write_file
from jfto_world.terrain import Dem

_SIZE_LIMIT = 50_000_000


def write_report(
    directory: Path,
    title: str,
    plan: Plan,
    comparison: Comparison,
    dem: Dem,
    scene: str,
    wind_mps: float,
    watcher: Watcher,
    flight: FlightFacts | None = None,
) -> Path:
    """Write report.html from a run's results and the figures that lie in its directory."""
    watcher.begin("report", "writing")
    content = ReportContent(
        title=title,
        plan=plan,
        comparison=comparison,
        dem=dem,
        scene=scene,
        figures={
            path.stem: path.read_bytes() for path in sorted((directory / FIGURES).glob("*.png"))
        },
        coverage=_coverage(directory / COVERAGE_NAME),
        configuration=read_text(directory / SCENARIO_NAME, InputError, "scenario", _SIZE_LIMIT),
        versions=versions(),
        spread=flight_spread(plan, wind_mps),
        wind_mps=wind_mps,
        flight=flight,
    )
    path = directory / REPORT_NAME
    write_file(path, report_page(content))
    watcher.end("report", f"{path.stat().st_size / 1e6:.1f} MB", "one file, works offline")
    return path


def _coverage(path: Path) -> Mapping[str, Any] | None:
    """Coverage figures of the run; None where its waypoints were not computed."""
    if not path.exists():
        return None
    try:
        found = json.loads(read_text(path, InputError, "coverage", _SIZE_LIMIT))
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}: is not valid JSON: {error.msg}. Delete it, or run the scenario again."
        ) from None
    assert isinstance(found, dict)
    return found
