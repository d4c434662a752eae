"""Entry point: finds the command, runs it, turns errors into words and exit statuses."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence

import click

from jfto import __version__
from jfto.cli.failure import EXIT_INTERRUPTED, EXIT_OTHER, show_error, show_unexpected
from jfto.cli.quick_order import quick_order
from jfto_msgs_py.errors import JftoError

# Command: its module in jfto.cli and what it does. Modules load when their command runs, so that
# help is instant.
COMMANDS = {
    "run": "Everything: coverage, routes, topology, power, comparison, report.",
    "coverage": "Camera waypoints over the terrain, and proof of what they see.",
    "plan": "Coverage and routes: write a verified plan.",
    "check": "Verify a plan with code that planning does not use.",
    "evaluate": "Compare C-TOP with MTP, A-LMST and CPAPO on a plan.",
    "report": "Rebuild the figures and the report of a run.",
    "mission": "Missions for ArduPilot: files, upload, verification.",
    "up": "The ROS 2 node graph of a scenario, without launch files.",
    "preflight": "Hold a plan against the vehicles that are to fly it.",
    "fly": "Fly a plan with real or simulated vehicles.",
    "sim": "Simulated ArduCopter vehicles on TCP and UDP.",
    "train": "Train the learned planner RL-TP.",
    "topic": "Topics of a ROS 2 graph: list, info, echo, hz, pub.",
    "node": "Nodes of a ROS 2 graph: list, info.",
    "service": "Services of a ROS 2 graph: list, call.",
    "param": "Parameters of ROS 2 nodes: list, get, set, dump.",
    "bag": "ROS 2 bags: record, info, play, replay.",
    "doctor": "What is installed, what is missing, what to do.",
}


class _LazyGroup(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return list(COMMANDS)

    def get_command(
        self,
        ctx: click.Context,  # noqa: ARG002
        cmd_name: str,
    ) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command = importlib.import_module(f"jfto.cli.{cmd_name}").command
        assert isinstance(command, click.Command)
        return command

    def format_commands(
        self,
        ctx: click.Context,  # noqa: ARG002
        formatter: click.HelpFormatter,
    ) -> None:
        with formatter.section("Commands, in the order of use"):
            formatter.write_dl(list(COMMANDS.items()))


@click.command(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, "--version", message="jfto %(version)s")
def cli() -> None:
    """Plan a multirotor fleet that photographs a mountainside and keeps a live mesh.

    \b
    Begin with:  jfto run config/demo.yaml
    Change any key of a scenario:  jfto run config/demo.yaml --set network.k_min=1

    Exit status: 0 fine, 2 bad input, 3 infeasible (closest plan kept, if any), 130 interrupted,
    1 anything else.
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments
        Without the name of the program; None: those of the process.

    Returns
    -------
    int
        Exit status.
    """
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    for stream in (sys.stdout, sys.stderr):
        # A terminal that lacks a character shows a question mark instead of a traceback.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    as_json, debug = "--json" in arguments, "--debug" in arguments
    # For whoever has to find a cause: tracebacks instead of sentences, whatever the command.
    arguments = [one for one in arguments if one != "--debug"]
    try:
        result = quick_order(arguments)
        if result is None:
            result = cli.main(arguments, prog_name="jfto", standalone_mode=False)
        return result if isinstance(result, int) else 0
    except click.ClickException as error:
        error.show()
        return 2
    except (KeyboardInterrupt, click.Abort):
        click.echo("Interrupted. Nothing was written.", err=True)
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader of our output left, as `head` does; nothing more can be said to it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_OTHER
    except JftoError as error:
        if debug:
            raise
        return show_error(error, as_json=as_json)
    except Exception as error:
        if debug:
            raise
        return show_unexpected(error, as_json=as_json)
