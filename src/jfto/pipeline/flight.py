"""The flight of a run directory: read from its bags, held against the plan, drawn and written."""

from __future__ import annotations

import json
import re
from pathlib import Path

from jfto.analysis.comparison import Comparison
from jfto.analysis.endings import left_the_ground
from jfto.analysis.facts import FlightFacts, facts_of
from jfto.analysis.flight_file import flight_facts_object
from jfto.analysis.read_bag import read_flight
from jfto.console.progress import Watcher
from jfto.planning.scenario_file import LoadedScenario
from jfto.report.figures.flown_certificate import flown_certificate
from jfto.report.figures.flown_events import flown_events
from jfto.report.figures.flown_map import flown_map
from jfto.report.figures.flown_network import flown_network
from jfto.report.figures.flown_timing import flown_timing
from jfto.report.figures.style import save
from jfto.supervision.graph_table import BAG_NAME
from jfto_msgs_py.errors import InputError, JftoError
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.write_file import write_file
from jfto_world.terrain import Dem

FLIGHT_NAME = "flight.json"
# A recorder that is started again goes on in bag-2, bag-3 and so on.
_BAG = re.compile(re.escape(BAG_NAME) + r"(?:-(\d+))?")
_STAGE = "as flown"


def flight_bags(directory: Path) -> list[Path]:
    """Bags of a run in the order in which they were begun; empty where nothing was recorded."""
    found = [(_BAG.fullmatch(path.name), path) for path in directory.iterdir() if path.is_dir()]
    return [path for _, path in sorted((int(name[1] or 1), path) for name, path in found if name)]


def fly_again(
    directory: Path,
    loaded: LoadedScenario,
    plan: Plan,
    comparison: Comparison,
    dem: Dem,
    watcher: Watcher,
) -> FlightFacts | None:
    """Facts of the flight on record, which are also written to flight.json.

    None without a bag, and where the bag holds no flight, as after a dry run; that is told.
    """
    bags = flight_bags(directory)
    if not bags:
        return None
    watcher.begin(_STAGE, "reading the bag")
    try:
        facts = _facts(bags, loaded, plan, comparison, dem, watcher)
    except JftoError as error:
        watcher.end(_STAGE, "nothing", str(error), good=False)
        return None
    text = json.dumps(flight_facts_object(facts), indent=1) + "\n"
    write_file(directory / FLIGHT_NAME, text)
    watcher.end(
        _STAGE,
        f"{facts.visited}/{len(facts.passages)} waypoints",
        f"worst {facts.worst_late_s:+.1f} s and {facts.worst_closest_m:.1f} m, "
        f"{100 * facts.certificate.clean_share:.1f} % of slots clean, "
        f"{100 * facts.throughput.ratio:.1f} % of the planned throughput",
        good=facts.good,
    )
    return facts


def _facts(
    bags: list[Path],
    loaded: LoadedScenario,
    plan: Plan,
    comparison: Comparison,
    dem: Dem,
    watcher: Watcher,
) -> FlightFacts:
    flight = read_flight(bags, plan)
    if not left_the_ground(flight, plan):
        raise InputError(f"{bags[0]}: nobody left the ground. The report is of the plan alone.")
    watcher.advance(0.6, "holding it against the plan")
    guided = loaded.scenario.trajectory.mode == "guided"
    return facts_of(
        flight,
        plan,
        comparison.ours,
        dem,
        n_dc=loaded.scenario.evaluation.n_dc,
        # Legs of the autopilot are kept clear of the ground at upload, by no set height.
        clearance_m=loaded.scenario.trajectory.clearance_m if guided else 0.0,
    )


def draw_flight(facts: FlightFacts, dem: Dem, folder: Path) -> None:
    """Write the flight's figures to `folder`."""
    drawings = {
        "flown_map": lambda: flown_map(facts, dem),
        "flown_timing": lambda: flown_timing(facts),
        "flown_certificate": lambda: flown_certificate(facts),
        "flown_network": lambda: flown_network(facts),
        "flown_events": lambda: flown_events(facts),
    }
    folder.mkdir(parents=True, exist_ok=True)
    for stem, draw in drawings.items():
        save(draw(), folder / stem)
