"""jfto up."""

from __future__ import annotations

import signal
import threading
from datetime import datetime, timezone
from pathlib import Path

import click

from jfto.cli.options import debug_option, load, out_option, scenario_argument, set_option

EXIT_UNCLEAN = 1
# Status of a node given up: this plus its place in the order of starting.
EXIT_NODE = 10
_PATH = click.Path(path_type=Path)


@click.command("up")
@scenario_argument
@out_option("DIR", "up-<UTC time>")
@click.option("--plan", "plan_file", type=_PATH, metavar="FILE", help="Plan to fly; else planned.")
@click.option(
    "--poses",
    type=click.Choice(["none", "plan"]),
    default="none",
    show_default=True,
    help="plan: play the planned positions as poses, where there are no vehicles.",
)
@click.option(
    "--start-delay",
    type=click.FloatRange(0.0),
    default=10.0,
    show_default=True,
    metavar="S",
    help="Lift-off after this many seconds.",
)
@click.option(
    "--horizon", type=click.IntRange(0), default=10, show_default=True, metavar="SLOTS",
    help="Slots solved ahead; 0: all that are left. The scenario's horizon_slots wins.",
)  # fmt: skip
@click.option("--for", "duration", type=click.FloatRange(0.0), metavar="S", help="End after S.")
@click.option("--use-sim-time", is_flag=True, help="Take the time from /clock.")
@set_option
@debug_option
def command(
    scenario: Path,
    out: Path | None,
    plan_file: Path | None,
    poses: str,
    start_delay: float,
    horizon: int,
    duration: float | None,
    use_sim_time: bool,
    overrides: tuple[str, ...],
    debug: bool,  # noqa: ARG001  main() reads it
) -> int:
    """Run the node graph of SCENARIO without ROS 2, one supervised process per node.

    Planner, topology and power (and a pose player with --poses plan) are started in that order; one
    that dies is started again, waiting longer each time; Ctrl-C stops all in reverse order. Each
    node's output is in DIR/logs, the state of all in DIR/status.json.

    A DIR that is there already is gone on with: its plan, its lift-off, its energy account.

    Exit status: 0 stopped and all ended cleanly, 1 one did not, 10 the planner was given up,
    11 topology, 12 power, 13 the pose player.

    \b
    Example:  jfto up config/demo.yaml --poses plan
    """
    loaded = load(scenario, overrides)

    from jfto.run_directory import PLAN_NAME, SCENARIO_NAME, write_scenario
    from jfto.supervision.graph import GraphOptions, graph_commands
    from jfto.supervision.supervisor import LOGS, Supervisor
    from jfto_msgs_py.plan_file import read_plan, write_plan

    if out is None:
        out = Path(datetime.now(timezone.utc).strftime("up-%Y%m%dT%H%M%SZ"))
    directory = out.resolve()
    write_scenario(loaded, directory / SCENARIO_NAME)
    if plan_file is not None:
        # A copy: replanning writes to it.
        write_plan(read_plan(plan_file), directory / PLAN_NAME)
    parameters: dict[str, dict[str, object]] = {
        "planner_node": {"start_delay_s": float(start_delay)},
        "topology_node": {"horizon_slots": horizon},
    }
    for name, values in loaded.node_options.items():
        parameters.setdefault(name, {}).update(values)
    nodes = graph_commands(
        GraphOptions(
            directory / SCENARIO_NAME,
            directory,
            directory / PLAN_NAME,
            play_poses=poses == "plan",
            use_sim_time=use_sim_time,
            parameters=parameters,
        )
    )
    click.echo(f"Logs          {directory / LOGS}   (Ctrl-C stops all)")
    supervisor = Supervisor(nodes, directory, _tell)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: supervisor.stop())
    timer = threading.Timer(duration or 0.0, supervisor.stop)
    timer.daemon = True
    if duration is not None:
        timer.start()
    outcome = supervisor.run()
    for name, how in outcome.failed.items():
        log = directory / LOGS / f"{name}.log"
        click.echo(f"✗ {name} {how}. Its last words:\n{_last_lines(log)}", err=True)
        return EXIT_NODE + [node.name for node in nodes].index(name)
    return EXIT_UNCLEAN if outcome.unclean else 0


def _tell(name: str, text: str) -> None:
    click.echo(f"{datetime.now().astimezone():%H:%M:%S}  {name:<14} {text}")


def _last_lines(log: Path, count: int = 5) -> str:
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()[-count:]
    return "\n".join(f"    {line}" for line in lines)
