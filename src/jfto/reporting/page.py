"""The page: everything of a run in one file that works offline."""

from __future__ import annotations

import base64
import math
import platform
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from jfto import __version__, words
from jfto.analysis.certificate import FlownException
from jfto.analysis.comparison import Comparison
from jfto.analysis.facts import FlightFacts
from jfto.analysis.motion import flight_spread, spread_text
from jfto.analysis.paper import (
    GROUND_HEADINGS,
    HEADINGS,
    PAPER,
    active_text,
    beside_paper,
    ground_cells,
    number,
    ratios_text,
)
from jfto.reporting.palette import uav_colour
from jfto.reporting.scene import FLOWN, scene_data
from jfto_mavlink.preflight.page import Preflight
from jfto_msgs_py.environment import version_of
from jfto_msgs_py.records.event import WARN, grade
from jfto_msgs_py.records.passage import VISITED_M
from jfto_msgs_py.records.plan import Plan
from jfto_world.terrain import Dem

# More of these are folded away, or left to the plan file.
_EVENTS_SHOWN, _VIOLATIONS_SHOWN = 40, 200
# How a plan is flown, by its time model.
_FLIGHTS = {
    "constant_speed": "Straight legs at constant speed, without turns or take-off: for comparison "
    "with published results, not for flights.",
    "arducopter": "Waypoint missions, timed as ArduCopter flies them in calm air.",
    "bezier": "Bezier trajectories, streamed by the clock: slots are absolute.",
}
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


@dataclass(frozen=True)
class ReportContent:
    """What a report shows.

    `scene` names the scene of the paper to compare with, `figures` maps file stems to PNG bytes,
    `coverage` is the coverage certificate's figures as in coverage.json, or None where waypoints
    were drawn at random, `configuration` the resolved scenario file. `dem` is None where the
    terrain is unknown. Arrivals are also said for a wind of `wind_mps`; `flight` is None until the
    plan was flown, `preflight` where no vehicle was looked at.
    """

    plan: Plan
    comparison: Comparison
    dem: Dem | None
    scene: str
    wind_mps: float
    figures: Mapping[str, bytes]
    coverage: Mapping[str, Any] | None
    configuration: str
    flight: FlightFacts | None = None
    preflight: Preflight | None = None

    @property
    def title(self) -> str:
        """What was planned, in a few words."""
        count = len(self.plan.uavs)
        return f"{count} UAV{'s' * (count != 1)} over {self.plan.photo_count} waypoints"


def report_page(content: ReportContent) -> str:
    """The whole report as HTML text."""
    from plotly.offline import get_plotlyjs

    plan, flight = content.plan, content.flight
    spread = flight_spread(plan, content.wind_mps)
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            content=content,
            figures={stem: base64.b64encode(png).decode() for stem, png in content.figures.items()},
            how_flown=_FLIGHTS.get(plan.time_model, plan.time_model),
            plotly=Markup(get_plotlyjs()),  # noqa: S704  ours, not the user's
            scene=scene_data(plan, content.comparison, content.dem, flight),
            spread=spread,
            spread_text=spread_text(spread, content.wind_mps),
            versions=_versions(),
        )
    )


def _environment() -> Environment:
    """Templates with the words and numbers that they are written in; all text is escaped."""
    environment = Environment(
        loader=PackageLoader("jfto.reporting"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    environment.filters |= {
        "colour": uav_colour,
        "endings": _endings_text,
        "kinds": _kinds_text,
        "level": grade,
        "measured": words.measured,
        "number": lambda value, decimals, signed=False: number(value, decimals, signed=signed),
        "power_sources": _power_sources,
    }
    environment.tests["finite"] = math.isfinite
    environment.globals |= {
        "active_text": active_text,
        "beside_paper": beside_paper,
        "events_shown": _EVENTS_SHOWN,
        "flown_name": FLOWN,
        "headings": HEADINGS,
        "ground_headings": GROUND_HEADINGS,
        "ground_cells": ground_cells,
        "least_margin": Markup("Least margin on a K<sub>min</sub>-th neighbour at P<sub>max</sub>"),
        "paper": PAPER,
        "ratios_text": ratios_text,
        "static": _static,
        "tightest_energy": _tightest_energy,
        "violations_shown": _VIOLATIONS_SHOWN,
        "visited_m": VISITED_M,
        "warn": WARN,
        "words": words,
    }
    return environment


def _static(name: str) -> Markup:
    """A file of the page's own, as it is."""
    text = (resources.files("jfto.reporting") / "static" / name).read_text(encoding="utf-8")
    return Markup(text)  # noqa: S704  ours, not the user's


def _versions() -> dict[str, str]:
    """Versions of JFTO, Python and the libraries that a plan's figures depend on."""
    libraries = ("numpy", "scipy", "numba", "rasterio", "pyproj", "matplotlib", "plotly")
    found = {"JFTO": __version__, "Python": platform.python_version()}
    return found | {name: version for name in libraries if (version := version_of(name))}


def _tightest_energy(plan: Plan) -> tuple[float, float, str]:
    """Floor and budget in J, and the name of the UAV that has the greatest share to spend."""
    assert plan.certificate is not None
    floor = np.array(plan.certificate.energy_floor_j)
    budget = np.array([uav.energy_j for uav in plan.uavs])
    uav = int(np.argmax(floor / budget))
    return float(floor[uav]), float(budget[uav]), plan.uavs[uav].id


def _endings_text(facts: FlightFacts) -> str:
    counts = Counter(one.how for one in facts.endings)
    if set(counts) == {"landed"}:
        return "all landed"
    return ", ".join(f"{count} {how}" for how, count in counts.items())


def _power_sources(facts: FlightFacts) -> str:
    counts = Counter(steps.source for steps in facts.flight.powers.values())
    return ", ".join(f"{count} × {source}" for source, count in counts.items())


def _kinds_text(exceptions: Sequence[FlownException]) -> str:
    counts = Counter(one.kind for one in exceptions)
    return ", ".join(f"{count} × {_KINDS[kind]}" for kind, count in counts.most_common())
