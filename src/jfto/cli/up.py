"""jfto up."""

from __future__ import annotations

import signal
import threading
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.options import (
    PATH,
    key_option,
    load,
    out_option,
    roster_texts,
    scenario_argument,
    set_option,
    speedup_option,
    vehicles_option,
)
from jfto.supervision.graph_table import HORIZON_SLOTS, START_DELAY_S
from jfto_msgs_py.ros.installation import require_ros

if TYPE_CHECKING:
    from jfto.planning.scenario_file import LoadedScenario
    from jfto.supervision.graph_table import GraphOptions, Vehicles

EXIT_UNCLEAN = 1
# How long others on the ROS domain are listened for.
_LISTEN_S = 1.0


@click.command("up")
@scenario_argument
@out_option("DIR", "up-<UTC time>")
@click.option("--plan", "plan_file", type=PATH, metavar="FILE", help="Plan to fly; else planned.")
@click.option(
    "--poses",
    type=click.Choice(["none", "plan"]),
    default="none",
    show_default=True,
    help="plan: play the planned positions as poses, where there are no vehicles.",
)
@vehicles_option()
@key_option
@speedup_option
@click.option("--arm", is_flag=True, help="Let /jfto/mission/start arm vehicles that are real.")
@click.option("--record", is_flag=True, help="Record the graph to DIR/bag (mcap).")
@click.option(
    "--start-delay",
    type=click.FloatRange(0.0),
    default=START_DELAY_S,
    show_default=True,
    metavar="S",
    help="Lift-off after this many seconds.",
)
@click.option(
    "--horizon",
    type=click.IntRange(0),
    default=HORIZON_SLOTS,
    show_default=True,
    metavar="SLOTS",
    help="Slots solved ahead; 0: all that are left. The scenario's horizon_slots wins.",
)
@click.option("--for", "duration", type=click.FloatRange(0.0), metavar="S", help="End after S.")
@click.option("--use-sim-time", is_flag=True, help="Take the time from /clock.")
@set_option
def command(
    scenario: Path,
    out: Path | None,
    plan_file: Path | None,
    overrides: tuple[str, ...],
    duration: float | None,
    **choices: Any,
) -> int:
    """Run the node graph of SCENARIO without ros2 launch, one supervised process per node.

    Planner, topology and power are started, and what --poses, --vehicles and --record ask for; one
    that dies is started again, waiting longer each time; Ctrl-C stops all in reverse order. Each
    node's output is in DIR/logs, the state of all in DIR/status.json.

    Nothing is armed by this: the services /jfto/mission/upload and start are there to be called.
    Where vehicles are simulated, the whole graph keeps their time, which --speedup makes faster.

    A DIR that is there already is gone on with: its plan, its lift-off, its energy account.

    Exit status: 0 stopped and all ended cleanly, 1 one did not, 10 the planner was given up,
    11 topology, 12 power, 13 the pose player, 14 the bridge, 15 the simulated vehicles,
    16 the recorder, 17 their radios.

    \b
    Example:  jfto up config/demo.yaml --vehicles sim --speedup 5 --record
              jfto service call /jfto/mission/upload std_srvs/srv/Trigger
              jfto service call /jfto/mission/start std_srvs/srv/Trigger
    """
    require_ros()
    loaded = load(scenario, overrides)

    from jfto.supervision.graph import graph_commands
    from jfto.supervision.graph_table import EXIT_STATUSES
    from jfto.supervision.supervisor import LOGS, Supervisor

    options = graph_of(loaded, out, plan_file, choices)
    directory = options.directory
    commands = graph_commands(options)
    # Power and radio nodes may run aboard, one for each UAV.
    _require_alone({each.name for each in commands} - {"power_node", "radio_node"})
    click.echo(f"Logs          {directory / LOGS}   (Ctrl-C stops all)")
    supervisor = Supervisor(commands, directory, _tell)
    # Whatever ends it comes once: a second Ctrl-C finds it ending.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: supervisor.stop())
    timer = threading.Timer(duration or 0.0, supervisor.stop)
    timer.daemon = True
    if duration is not None:
        timer.start()
    outcome = supervisor.run()
    for name, how in outcome.failed.items():
        log = directory / LOGS / f"{name}.log"
        click.echo(f"✗ {name} {how}. Its last words:\n{_last_lines(log)}", err=True)
        return EXIT_STATUSES[name]
    return EXIT_UNCLEAN if outcome.unclean else 0


def _require_alone(names: set[str]) -> None:
    """Refuse to start nodes that run on this ROS domain already; raises InputError."""
    from jfto.cli.ros_options import session_of
    from jfto.ros_cli import graph
    from jfto_msgs_py.errors import InputError

    with session_of(_LISTEN_S) as session:
        running = {each.rpartition("/")[2] for each in graph.nodes(session.node)} & names
    if running:
        raise InputError(
            f"another graph runs on this ROS domain ({', '.join(sorted(running))}). End it, or set "
            "ROS_DOMAIN_ID to another number for this one. Nothing was started."
        )


def graph_of(
    loaded: LoadedScenario, out: Path | None, plan_file: Path | None, choices: Mapping[str, Any]
) -> GraphOptions:
    """What is to run, in a directory that has its scenario and the plan, where one is given."""
    from jfto.pipeline.directory import PLAN_NAME, make_run_directory, write_scenario
    from jfto.planning.scenario_file import SCENARIO_NAME
    from jfto.supervision.graph_table import GraphOptions, suited_to
    from jfto_msgs_py.plan_file import read_plan, write_plan

    vehicles = _vehicles(loaded, choices)
    directory = make_run_directory(out, "up").resolve()
    write_scenario(loaded, directory / SCENARIO_NAME)
    if plan_file is not None:
        # A copy: replanning writes to it.
        write_plan(read_plan(plan_file), directory / PLAN_NAME)
    return GraphOptions(
        directory / SCENARIO_NAME,
        directory,
        directory / PLAN_NAME,
        vehicles,
        play_poses=choices["poses"] == "plan",
        record=choices["record"],
        use_sim_time=choices["use_sim_time"],
        sections=loaded.node_options,
        suited=suited_to(float(choices["start_delay"]), choices["horizon"]),
    )


def _vehicles(loaded: LoadedScenario, choices: Mapping[str, Any]) -> Vehicles | None:
    """Who flies as --vehicles has it; None where nobody does. Raises InputError, RosterError."""
    from jfto.supervision.vehicles import choose_vehicles
    from jfto_msgs_py.errors import InputError

    texts = roster_texts(choices["vehicles"])
    if not texts:
        idle = [name for name in ("key_file", "arm") if choices[name]]
        if idle or choices["speedup"] != 1.0:
            raise InputError("--key, --arm and --speedup are for vehicles. Name them: --vehicles.")
        return None
    if choices["poses"] != "none":
        raise InputError("--poses plan is for graphs without --vehicles. Leave one out.")
    options = loaded.node_options.get("mavlink_bridge", {})
    return choose_vehicles(
        texts,
        loaded.scenario.fleet.ids,
        options,
        speedup=choices["speedup"],
        arm=choices["arm"],
        key_file=choices["key_file"],
    )


def _tell(name: str, text: str) -> None:
    click.echo(f"{datetime.now().astimezone():%H:%M:%S}  {name:<15} {text}")


def _last_lines(log: Path, count: int = 5) -> str:
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()[-count:]
    return "\n".join(f"    {line}" for line in lines)
