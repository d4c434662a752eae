"""jfto preflight."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.options import (
    PATH,
    json_option,
    key_option,
    print_json,
    roster_texts,
    set_option,
    vehicles_option,
)

if TYPE_CHECKING:
    from jfto.planning.scenario_file import LoadedScenario
    from jfto_mavlink.preflight.page import Preflight
    from jfto_msgs_py.records.plan import Plan

# Vehicles that are looked at are on: they need no minutes to become ready.
_WAIT_S = 20.0
_SIMULATED_SPEEDUP = 10.0


@click.command("preflight")
@click.argument("source", metavar="PLAN|SCENARIO|DIR", type=PATH)
@click.option(
    "--scenario",
    "scenario_file",
    type=PATH,
    metavar="FILE",
    help="What a plan is flown under. Default: scenario.yaml beside it, else what it says itself.",
)
@set_option
@vehicles_option(required=True)
@key_option
@json_option
def command(source: Path, as_json: bool, **choices: Any) -> int:
    """Hold a plan against the vehicles that are to fly it; nothing is sent, changed or armed.

    Per vehicle: who answers, its pad, position, its own checks, its clock, the mission against its
    fence, speeds, RTL height over the terrain, charge against the time with the way home, wind,
    failsafes, and the parameters that a flight will change. Each finding is fine, to be looked at,
    or stops a flight, with its cure. PLAN is a plan file, DIR the directory of a run; a SCENARIO is
    planned first.

    Exit status: 0 nothing stops a flight, 1 something does, 2 bad input.

    \b
    Example:  jfto preflight today/plan.json --vehicles udpin:0.0.0.0:14550
    """
    from jfto_mavlink.preflight.page import RED

    loaded, plan = _plan(source, choices)
    page = _look(loaded, plan, choices, quiet=as_json)
    if as_json:
        print_json({"level": page.level, "counts": page.counts(), **asdict(page)})
    else:
        _print(page)
    return 1 if page.level == RED else 0


def _plan(source: Path, choices: dict[str, Any]) -> tuple[LoadedScenario, Plan]:
    """The plan that is meant, and what it is flown under."""
    import tempfile

    from jfto.console.stages import show_stages
    from jfto.pipeline.directory import PLAN_NAME
    from jfto.pipeline.run import Pipeline
    from jfto.planning.scenario_file import load_scenario
    from jfto.planning.scenario_of_plan import load_scenario_for
    from jfto_msgs_py.plan_file import read_plan

    path = source / PLAN_NAME if source.is_dir() else source
    if path.suffix == ".json":
        return load_scenario_for(path, choices["scenario_file"], choices["overrides"]), read_plan(
            path
        )
    loaded = load_scenario(path, choices["overrides"])
    with tempfile.TemporaryDirectory() as directory, show_stages() as progress:
        return loaded, Pipeline(loaded, Path(directory), progress).plan().plan


def _look(loaded: LoadedScenario, plan: Plan, choices: dict[str, Any], *, quiet: bool) -> Preflight:
    """Ask the vehicles; those that are silent are on the page too."""
    from jfto.console.console import Console
    from jfto.console.vehicles import VehicleProgress
    from jfto.flight.fleet_link import Simulated, open_fleet
    from jfto.node_options import SimulatedFleetOptions
    from jfto.planning.terrain import known_ground
    from jfto.supervision.vehicles import named
    from jfto_mavlink.fleet.fly import Fleet, preflight
    from jfto_mavlink.fleet.roster import are_simulated
    from jfto_mavlink.mission.build import build_missions
    from jfto_mavlink.operation import mission_settings
    from jfto_mavlink.options import BridgeOptions
    from jfto_mavlink.preflight.settings import gate_settings

    section = loaded.node_options.get("mavlink_bridge", {})
    dem = known_ground(loaded)
    ground = None if dem is None else dem.top_height
    settings = mission_settings(plan, BridgeOptions(**section))
    missions = {one.uav: one for one in build_missions(plan, settings, ground=ground)}
    gate = gate_settings(plan, loaded.scenario, ground, guided=bool(plan.trajectories))
    texts, endpoints = named(roster_texts(choices["vehicles"]), section)
    simulated = are_simulated(texts)
    how = Simulated()
    if simulated:
        fleet_options = SimulatedFleetOptions(**loaded.node_options.get("simulated_fleet", {}))
        how = Simulated(_SIMULATED_SPEEDUP, fleet_options.faults)
    with (
        Console(quiet=quiet) as console,
        open_fleet(
            texts,
            plan,
            simulated=how,
            key_file=choices["key_file"],
            complete=False,
            endpoints=endpoints,
        ) as link,
    ):
        fleet = Fleet(link, missions, VehicleProgress(console).report)
        return preflight(
            fleet, replace(gate, wait_s=_WAIT_S * (3 if simulated else 1), waited_for=True)
        )


def _print(page: Preflight) -> None:
    from rich.console import Console as Rich

    from jfto.console.console import Console
    from jfto.console.preflight import show_page

    show_page(Console(rich=Rich(highlight=False)), page)
