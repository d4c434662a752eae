"""jfto run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.options import (
    PATH,
    Function,
    json_option,
    key_option,
    out_option,
    roster_texts,
    scenario_options,
    vehicles_option,
)

if TYPE_CHECKING:
    from jfto.console.stages import StageProgress
    from jfto.flight.job import FlightEnd, FlightJob
    from jfto.pipeline.run import Run
    from jfto.planning.scenario_file import LoadedScenario
    from jfto.supervision.graph_table import Vehicles


def flight_options(function: Function) -> Function:
    """Who flies, how far, and with whose word: options of `run` and `fly`."""
    for option in reversed(
        (
            out_option("DIR", "run-<UTC time>"),
            click.option(
                "--until",
                type=click.Choice(["plan", "upload", "arm"]),
                help="Stop there: plan and compare at the desk; missions on board and verified; "
                "every check before arming passed. Nothing is armed.",
            ),
            vehicles_option(default=("sim",), show_default=True),
            key_option,
            click.option(
                "--speedup",
                type=click.FloatRange(0.1, 50.0),
                help="Simulated vehicles: times real time. Default: what this computer carries, at "
                "most 10.",
            ),
            click.option(
                "--gates",
                metavar="K,K…[@S]",
                help="Time gates: all wait behind their K-th waypoint for its planned time, so "
                "that slots are kept by the clock. Lift-off is S seconds after the graph is "
                "started; default: as soon as can be counted on.",
            ),
            click.option("--arm", is_flag=True, help="Arm vehicles that are real without asking."),
            json_option,
        )
    ):
        function = option(function)
    return function


@click.command("run")
@scenario_options(required=False)
@click.option("--plan", "plan_file", type=PATH, metavar="FILE", help="Plan to fly; else planned.")
@click.option(
    "--resume",
    "resumed",
    type=PATH,
    metavar="DIR",
    help="Instead of SCENARIO: take over the flight of DIR, whose jfto run was killed while its "
    "vehicles fly on.",
)
@click.option(
    "--sortie",
    type=click.IntRange(1),
    metavar="N",
    help="Where one flight does not do: the one to fly. Default: the first.",
)
@flight_options
def command(
    loaded: LoadedScenario | None, plan_file: Path | None, resumed: Path | None, **choices: Any
) -> int:
    """Plan SCENARIO, fly it, adapt to how it is really flown, record it and report.

    Coverage, routes, topology and power are planned and certified; the missions are uploaded and
    read back; the fleet flies while topology and power are solved anew on the measured poses. Plan,
    bag, vehicle logs and report go to one directory. Vehicles are simulated unless --vehicles names
    others: those are armed on --arm or on a typed word only.

    Where one flight does not do, sorties are planned, and one is flown at a time, in DIR/sortie-N:
    name the same DIR each time, and what one left undone is added to the next.

    Ctrl-C before the start leaves everything on the ground. In flight the first one orders the
    fleet home and follows it until it is down, the second leaves it on its way.

    Exit status: 0 flown as planned, 1 not (a waypoint missed, a rule broken, not started),
    2 bad input, 3 infeasible and not flown, 130 interrupted.

    \b
    Example:  jfto run config/demo.yaml
              jfto run mine.yaml -o field --sortie 2
              jfto run mine.yaml --until arm --vehicles udpin:0.0.0.0:14550
              jfto run --resume flight
    """
    if resumed is not None:
        if loaded is not None or plan_file is not None:
            raise click.UsageError("--resume DIR has scenario and plan: give nothing else.")
        return _resume(resumed.resolve(), as_json=choices["as_json"])
    if loaded is None:
        raise click.UsageError("Missing argument 'SCENARIO'.")
    if plan_file is not None and choices["sortie"]:
        raise click.UsageError("--plan names the sortie to fly: leave --sortie out.")
    return run(loaded, plan_file, choices)


def _resume(directory: Path, *, as_json: bool) -> int:
    """Take over a flight, follow it to its end, and report."""
    from jfto.cli.results import print_run, run_status
    from jfto.console.stages import show_stages
    from jfto.flight.job_file import resumed_job
    from jfto.pipeline.directory import PLAN_NAME
    from jfto.pipeline.run import Pipeline, Run
    from jfto.planning.scenario_file import SCENARIO_NAME, load_scenario
    from jfto_msgs_py.plan_file import read_plan

    loaded = load_scenario(directory / SCENARIO_NAME)
    planned = Run(read_plan(directory / PLAN_NAME), directory / PLAN_NAME)
    job = resumed_job(directory, planned.plan)
    with show_stages(quiet=as_json) as progress:
        progress.console.line(_scenario_line(loaded))
        end = _conduct(job, progress)
        finished = Pipeline(loaded, directory, progress).report(planned)
    print_run(loaded, finished, end, as_json=as_json)
    return run_status(finished, end)


def run(loaded: LoadedScenario, plan_file: Path | None, choices: dict[str, Any]) -> int:
    """Plan, or take `plan_file`; fly; report. `choices` are those of `flight_options`."""
    from jfto.cli.failure import EXIT_INFEASIBLE, EXIT_INTERRUPTED
    from jfto.cli.results import next_sortie, print_run, run_status
    from jfto.console.stages import show_stages
    from jfto.pipeline.directory import make_run_directory, require_no_flight, what_is_kept
    from jfto.pipeline.run import Pipeline
    from jfto.pipeline.sortie_run import report_others, sortie_run

    as_json = choices["as_json"]
    vehicles = None if choices["until"] == "plan" else _vehicles(loaded, choices)
    whole = directory = make_run_directory(choices["out"]).resolve()
    if vehicles is not None:
        require_no_flight(directory)
    flight, number = None, choices.get("sortie")
    with show_stages(quiet=as_json) as progress:
        progress.console.line(_scenario_line(loaded))
        pipeline = Pipeline(loaded, directory, progress)
        try:
            planned = pipeline.plan() if plan_file is None else pipeline.take(plan_file)
            if planned.interrupted:
                raise KeyboardInterrupt
            all_planned = planned
            if planned.sorties or number:
                pipeline, planned = sortie_run(loaded, whole, planned, number or 1, progress)
                directory = planned.plan_path.parent
                if vehicles is not None:
                    require_no_flight(directory)
            if vehicles is not None and planned.plan.clean:
                _require_flight_times(planned.plan.time_model)
                flight = _fly(loaded, planned, vehicles, choices, progress)
            # A dry run draws nothing: what lies there from before still holds.
            dry = flight is not None and choices["until"] is not None
            finished = planned if dry else pipeline.report(planned)
            if not (dry or number):
                report_others(loaded, whole, all_planned, 1, progress)
        except KeyboardInterrupt:
            state = "" if flight is None else f" {flight.outcome.text}"
            progress.console.hide()
            click.echo(f"Interrupted.{state} {what_is_kept(directory)}", err=True)
            return EXIT_INTERRUPTED
    print_run(loaded, finished, flight, as_json=as_json)
    if not as_json and all_planned.sorties:
        click.echo(next_sortie(loaded.path, whole, finished.plan))
    return run_status(finished, flight) if finished.plan.clean else EXIT_INFEASIBLE


def _require_flight_times(time_model: str) -> None:
    """Refuse to fly a plan whose times no vehicle keeps; raises InputError."""
    from jfto_msgs_py.errors import InputError

    if time_model == "constant_speed":
        raise InputError(
            "trajectory.mode straight times legs without lift-off and turns, as studies do: flown, "
            "its slots would be half a minute late and more. Plan for flight, with --set "
            "trajectory.mode=waypoints (or guided); --until plan compares without a flight."
        )


def _scenario_line(loaded: LoadedScenario) -> str:
    fleet, terrain = loaded.scenario.fleet, loaded.scenario.terrain
    extent = " × ".join(f"{side / 1000:g}" for side in terrain.size_m)
    where = f"{extent} km" if extent else loaded.scenario.area.file or "area.polygon_deg"
    return f"Scenario    {loaded.path}   {fleet.count} UAVs, {where}, {terrain.source}"


def _vehicles(loaded: LoadedScenario, choices: dict[str, Any]) -> Vehicles:
    """Who flies; raises InputError or RosterError before anything is done."""
    from jfto.flight.gates import parse_gates
    from jfto.flight.operator import require_confirmation
    from jfto.flight.settings import default_speedup
    from jfto.supervision.vehicles import choose_vehicles
    from jfto_mavlink.fleet.roster import are_simulated
    from jfto_msgs_py.errors import InputError

    if choices["gates"]:
        parse_gates(choices["gates"])
    if choices["gates"] and loaded.scenario.trajectory.mode != "waypoints":
        raise InputError(
            "--gates is for plans with trajectory.mode waypoints: times of mode straight are not "
            "those that vehicles keep, and guided flights keep the clock by themselves."
        )

    if loaded.scenario.trajectory.mode == "straight":
        _require_flight_times("constant_speed")
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
        require_confirmation(simulated=vehicles.simulated, armed=choices["arm"])
    return vehicles


def _fly(
    loaded: LoadedScenario,
    planned: Run,
    vehicles: Vehicles,
    choices: dict[str, Any],
    progress: StageProgress,
) -> FlightEnd:
    """Run the graph and conduct the flight; what came of it is said in the lines of the stages."""
    from jfto.flight.gates import parse_gates
    from jfto.flight.job_file import write_job
    from jfto.flight.prepare import prepare
    from jfto.flight.settings import LANDED

    ask = not (vehicles.simulated or choices["arm"] or choices["until"])
    until, gates = choices["until"] or LANDED, choices["gates"]
    job = prepare(
        loaded,
        planned,
        vehicles,
        until=until,
        ask=ask,
        gates=parse_gates(gates) if gates else None,
    )
    if until == LANDED:
        write_job(job)
    return _conduct(job, progress)


def _conduct(job: FlightJob, progress: StageProgress) -> FlightEnd:
    """Run the graph of a job and conduct its flight."""
    from jfto.cli.results import say_flight
    from jfto.flight.job import fly
    from jfto.flight.operator import operator_at
    from jfto.pipeline.directory import forget_dry_run

    progress.begin("flight", "starting the graph")
    # The flight shows itself.
    progress.console.hide()
    with operator_at(progress.console, len(job.plan.uavs)) as operator:
        end = fly(job, operator)
    if not end.outcome.flown:
        forget_dry_run(job.directory)
    say_flight(job.plan, job, end, progress)
    return end
