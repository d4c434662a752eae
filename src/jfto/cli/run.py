"""jfto run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.mission_options import PATH, key_option, roster_texts
from jfto.cli.options import (
    debug_option,
    json_option,
    load,
    method_option,
    out_option,
    scenario_argument,
    seed_option,
    set_option,
)

if TYPE_CHECKING:
    from jfto.conduct.flight_job import FlightEnd
    from jfto.console.watcher import TerminalWatcher
    from jfto.pipeline.run import Run
    from jfto.planning.scenario_file import LoadedScenario
    from jfto.supervision.graph_table import Vehicles


@click.command("run")
@scenario_argument
@out_option("DIR", "run-<UTC time>")
@method_option
@seed_option
@click.option("--plan", "plan_file", type=PATH, metavar="FILE", help="Plan to fly; else planned.")
@click.option(
    "--until",
    type=click.Choice(["plan", "upload", "arm"]),
    help="Stop there: plan and compare at the desk; missions on board and verified; every check "
    "before arming passed. Nothing is armed.",
)
@click.option(
    "--vehicles",
    metavar="WHO",
    multiple=True,
    default=("sim",),
    show_default=True,
    help="sim: simulated ones. LINK: vehicles with system ids 1, 2 …, all on one link or each on "
    "its own (udpin:, udpout:, tcp:, serial:). UAV=SYSID@LINK[#UID] per vehicle. roster: those of "
    "the scenario's section mavlink_bridge. May be repeated or separated by commas.",
)
@key_option
@click.option(
    "--speedup",
    type=click.FloatRange(0.1, 50.0),
    help="Simulated vehicles: times real time. Default: what this computer carries, at most 10.",
)
@click.option("--arm", is_flag=True, help="Arm vehicles that are real without asking.")
@set_option
@json_option
@debug_option
def command(
    scenario: Path,
    out: Path | None,
    method: str | None,
    seed: int | None,
    overrides: tuple[str, ...],
    as_json: bool,
    debug: bool,  # noqa: ARG001  main() reads it
    **choices: Any,
) -> int:
    """Plan SCENARIO, fly it, adapt to how it is really flown, record it and report.

    Coverage, routes, topology and power are planned and certified; the missions are uploaded and
    read back; the fleet flies while topology and power are solved anew on the measured poses. Plan,
    bag, vehicle logs and report go to one directory. Vehicles are simulated unless --vehicles names
    others: those are armed on --arm or on a typed word only.

    Ctrl-C before the start leaves everything on the ground. In flight the first one orders the
    fleet home and follows it until it is down, the second leaves it on its way.

    Exit status: 0 flown as planned, 1 not (a waypoint missed, a rule broken, not started),
    2 bad input, 3 infeasible and not flown, 130 interrupted.

    \b
    Example:  jfto run config/demo.yaml
              jfto run mine.yaml --until arm --vehicles udpin:0.0.0.0:14550
    """
    loaded = load(scenario, overrides, seed, method)

    from jfto.cli.failure import EXIT_INFEASIBLE, EXIT_INTERRUPTED
    from jfto.console.run_summary import print_run, run_status
    from jfto.console.watcher import TerminalWatcher
    from jfto.pipeline.directory import make_run_directory, require_no_flight, what_is_kept
    from jfto.pipeline.run import rebuild, run_all
    from jfto.planning.routes import is_clean

    until, plan_file = choices["until"], choices["plan_file"]
    vehicles = None if until == "plan" else _vehicles(loaded, choices)
    directory = make_run_directory(out).resolve()
    if vehicles is not None:
        require_no_flight(directory)
    flight = None
    with TerminalWatcher(quiet=as_json) as watcher:
        _say_scenario(scenario, loaded, watcher)
        try:
            if vehicles is None and plan_file is None:
                run = run_all(loaded, directory, watcher)
            else:
                run = _plan(loaded, plan_file, directory, watcher)
                if run.interrupted:
                    raise KeyboardInterrupt
                if vehicles is not None and is_clean(run.plan):
                    flight = _fly(loaded, run, vehicles, choices, watcher)
                run = rebuild(directory, watcher)
        except KeyboardInterrupt:
            run = None
    if run is None or run.comparison is None:
        state = "" if flight is None else f" {flight.outcome.text}"
        click.echo(f"Interrupted.{state} {what_is_kept(directory)}", err=True)
        return EXIT_INTERRUPTED
    print_run(loaded, run, flight, as_json=as_json)
    return EXIT_INFEASIBLE if not is_clean(run.plan) else run_status(run, flight)


def _say_scenario(path: Path, loaded: LoadedScenario, watcher: TerminalWatcher) -> None:
    fleet, area = loaded.scenario.fleet, loaded.scenario.terrain.size_m
    watcher.console.print(
        f"Scenario    {path}   {fleet.count} UAVs, {area[0] / 1000:g} × {area[1] / 1000:g} km, "
        f"{loaded.scenario.terrain.source}",
        markup=False,
    )


def _vehicles(loaded: LoadedScenario, choices: dict[str, Any]) -> Vehicles:
    """Who flies; raises InputError or RosterError before anything is done."""
    from jfto.conduct.pace import default_speedup
    from jfto.conduct.word import require_word
    from jfto.supervision.vehicles import are_simulated, choose_vehicles

    texts, uavs = roster_texts(choices["vehicles"]), loaded.scenario.fleet.ids
    speedup = choices["speedup"]
    if speedup is None:
        guided = loaded.scenario.trajectory.mode == "guided"
        fast = are_simulated(texts) and not guided
        speedup = default_speedup(len(uavs)) if fast else 1.0
    vehicles = choose_vehicles(
        texts,
        uavs,
        loaded.node_options.get("mavlink_bridge", {}),
        speedup=speedup,
        # Nothing flies before the conductor has the word; it alone starts the fleet.
        arm=choices["until"] is None,
        key_file=choices["key_file"],
    )
    if choices["until"] is None:
        require_word(simulated=vehicles.simulated, armed=choices["arm"])
    return vehicles


def _plan(
    loaded: LoadedScenario, plan_file: Path | None, directory: Path, watcher: TerminalWatcher
) -> Run:
    from jfto.pipeline.run import plan_only, take_plan

    if plan_file is not None:
        return take_plan(loaded, plan_file, directory, watcher)
    return plan_only(loaded, directory, watcher)


def _fly(
    loaded: LoadedScenario,
    run: Run,
    vehicles: Vehicles,
    choices: dict[str, Any],
    watcher: TerminalWatcher,
) -> FlightEnd:
    """Run the graph and conduct the flight; what came of it is said in the watcher's lines."""
    from jfto.conduct.flight_job import fly
    from jfto.conduct.operator import Terminal
    from jfto.conduct.prepare import prepare
    from jfto.conduct.settings import LANDED
    from jfto.console.run_summary import say_flight

    ask = not (vehicles.simulated or choices["arm"] or choices["until"])
    job = prepare(loaded, run, vehicles, until=choices["until"] or LANDED, ask=ask)
    watcher.begin("flight", "starting the graph")
    watcher.pause()
    console = watcher.console
    with Terminal(console, len(run.plan.uavs), quiet=console.quiet) as operator:
        end = fly(job, operator)
    watcher.resume()
    say_flight(run.plan, job, end, watcher)
    return end
