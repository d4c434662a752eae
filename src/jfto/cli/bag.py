"""jfto bag."""

from __future__ import annotations

import contextlib
import itertools
import re
import time
from pathlib import Path
from typing import Any

import click

from jfto.cli.options import PATH
from jfto.cli.ros_options import session_of, spin_option

_RATE = click.FloatRange(0, min_open=True)
_SECONDS = click.FloatRange(0)


@click.group("bag")
def command() -> None:
    """ROS 2 bags: record, look inside, play, replay."""


@command.command("info")
@click.argument("bag", type=PATH)
@click.option("-t", "--topic-name", "names_only", is_flag=True, help="Print topic names only.")
def info(bag: Path, names_only: bool) -> int:
    """Show what BAG holds.

    BAG is a folder, or an .mcap or .db3 file. Unfinished recordings are read too.
    """
    from jfto.bag.contents import info_text
    from jfto.bag.reader import Bag

    facts = Bag(bag).facts
    if names_only:
        for topic in facts.named_topics:
            click.echo(topic.name)
    else:
        click.echo(info_text(facts))
    _say(facts.notes)
    return 0


def _say(notes: tuple[str, ...]) -> None:
    for note in notes:
        click.echo(note, err=True)


@command.command("record")
@click.argument("topics", nargs=-1)
@click.option("-a", "--all", "everything", is_flag=True, help="Record all topics.")
@click.option("-e", "--regex", metavar="REGEX", help="Record topics that match.")
@click.option("-x", "--exclude-topics", "excluded", multiple=True, metavar="TOPIC", help="But not.")
@click.option("-o", "--output", type=PATH, metavar="DIR", help="Folder to make.")
@click.option("--next-free", is_flag=True, help="If DIR is there, record to DIR-2 and so on.")
@click.option(
    "--use-sim-time",
    "sim_time",
    is_flag=True,
    help="Stamp messages with the time of /clock; nothing is recorded before it comes.",
)
@click.option("--compress", is_flag=True, help="Compress the messages with zstd.")
@click.option(
    "--params-file",
    type=PATH,
    metavar="FILE",
    help="Keep this parameter file in the bag, for `jfto bag replay`.",
)
@click.option(
    "--parameters",
    "ask_nodes",
    is_flag=True,
    help="Ask all nodes for their parameters and keep those in the bag.",
)
def record(
    topics: tuple[str, ...], output: Path | None, params_file: Path | None, **choices: Any
) -> int:
    """Record TOPICS until interrupted.

    Those that appear later are included. The bag is an mcap bag of version 9 that `ros2 bag` plays.
    A kill costs no more than the last second.
    """
    from jfto.bag.recorder import PARAMETERS_NAME, BagRecorder, Choice
    from jfto.supervision.process import die_with_parent
    from jfto_msgs_py.errors import InputError
    from jfto_msgs_py.files import read_text, write_file

    chosen = Choice(
        frozenset(topics),
        _pattern(choices["regex"]),
        choices["everything"],
        frozenset(choices["excluded"]),
    )
    if not (topics or chosen.is_open_ended):
        raise click.UsageError("Name topics, or give --all or --regex.")
    if params_file is not None and choices["ask_nodes"]:
        raise click.UsageError("--params-file and --parameters exclude each other.")
    kept = None if params_file is None else read_text(params_file, InputError, "parameter", 10**7)
    path = output or Path(time.strftime("rosbag2_%Y_%m_%d-%H_%M_%S"))
    path = _next_free(path) if choices["next_free"] else path
    if path.exists():
        raise click.BadParameter(f"'{path}' is there already.", param_hint="--output")
    die_with_parent()
    with session_of(node_name="rosbag2_recorder") as session:
        from jfto.bag.record import ParametersFile, Recording

        recorder = BagRecorder(path, compress=choices["compress"])
        if kept is not None:
            write_file(path / PARAMETERS_NAME, kept)
        asked = ParametersFile(session.node, path) if choices["ask_nodes"] else None
        try:
            Recording(session, recorder, chosen, asked, sim_time=choices["sim_time"]).run()
        finally:
            recorder.close()
    click.echo(f"{path}: {recorder.message_count} messages", err=True)
    return 0


def _next_free(path: Path) -> Path:
    """The path itself, or the first of PATH-2, PATH-3 … that is not there."""
    numbered = (path.with_name(f"{path.name}-{number}") for number in itertools.count(2))
    return next(each for each in itertools.chain([path], numbered) if not each.exists())


def _pattern(text: str | None) -> re.Pattern[str] | None:
    try:
        return None if text is None else re.compile(text)
    except re.error as error:
        raise click.BadParameter(str(error), param_hint="--regex") from None


@command.command("play")
@click.argument("bag", type=PATH)
@click.argument("more", nargs=-1, metavar="[TOPIC]... [OLD:=NEW]...")
@click.option("-r", "--rate", type=_RATE, default=1.0, metavar="N", help="N times as fast.")
@click.option("--topics", multiple=True, metavar="TOPIC", help="Play this topic; more may follow.")
@click.option(
    "--clock",
    "clock_hz",
    type=_RATE,
    is_flag=False,
    flag_value=40.0,
    metavar="[HZ]",
    help="Publish /clock, 40 times a second if not told otherwise.",
)
@click.option(
    "--start-offset",
    "start_offset_s",
    type=_SECONDS,
    default=0.0,
    metavar="SECONDS",
    help="Begin so far into the bag.",
)
@click.option("-l", "--loop", is_flag=True, help="Begin anew at the end.")
@click.option("-m", "--remap", multiple=True, metavar="OLD:=NEW", help="Play under another name.")
@spin_option
def play(
    bag: Path,
    more: tuple[str, ...],
    topics: tuple[str, ...],
    remap: tuple[str, ...],
    spin_time: float,
    **options: Any,
) -> int:
    """Publish the messages of BAG.

    They keep their rhythm, and the QoS that was recorded.
    """
    from jfto.bag.reader import Bag

    renamed = _remap([*remap, *(each for each in more if ":=" in each)])
    opened = Bag(bag)
    _say(opened.facts.notes)
    with session_of(spin_time, "rosbag2_player") as session:
        from jfto.bag.player import Player, PlayOptions
        from jfto.ros_cli.session import Stopped

        options["topics"] = frozenset((*topics, *(each for each in more if ":=" not in each)))
        options["remap"] = renamed
        # As in ros2 bag, an end before the end is no failure.
        with contextlib.suppress(Stopped):
            Player(session, opened, PlayOptions(**options)).run()
    return 0


def _remap(rules: list[str]) -> dict[str, str]:
    pairs = [rule.partition(":=") for rule in rules]
    for old, _, new in pairs:
        if not (old and new):
            raise click.BadParameter(f"'{old}' is not OLD:=NEW.", param_hint="--remap")
    return {old: new for old, _, new in pairs}


@command.command("replay")
@click.argument("bag", type=PATH)
@click.option(
    "--nodes",
    default="topology,power",
    show_default=True,
    metavar="NAMES",
    help="Nodes to feed, separated by commas.",
)
@click.option(
    "--params-file",
    type=PATH,
    metavar="FILE",
    help="Parameters of the run: its scenario. Default: BAG/parameters.yaml.",
)
@click.option(
    "--tolerance",
    "tolerance_db",
    type=_SECONDS,
    default=0.05,
    show_default=True,
    metavar="DB",
    help="By how much powers may differ; links may not.",
)
@click.option("-o", "--output", type=PATH, metavar="DIR", help="Write the outputs as a bag.")
def replay(
    bag: Path,
    nodes: str,
    params_file: Path | None,
    tolerance_db: float,
    output: Path | None,
) -> int:
    """Feed BAG to nodes and compare their outputs.

    No network and no clock: the same bag gives the same outputs. Status 0 if all are within the
    tolerance of what was recorded, 1 if not.
    """
    from jfto_msgs_py.ros.installation import require_ros

    require_ros()
    from jfto.bag.reader import Bag
    from jfto.bag.recorder import PARAMETERS_NAME
    from jfto.bag.replay import NODES, replay_bag, write_outputs

    names = [name.strip() for name in nodes.split(",") if name.strip()]
    if not names or not set(names) <= set(NODES):
        raise click.BadParameter(f"choose from {', '.join(NODES)}.", param_hint="--nodes")
    folder = bag if bag.is_dir() else bag.parent
    opened = Bag(bag)
    _say(opened.facts.notes)
    found = replay_bag(opened, names, params_file or folder / PARAMETERS_NAME, tolerance_db)
    if output is not None:
        write_outputs(found, output)
    click.echo(f"{found.input_count} inputs, {len(found.outputs)} outputs, {found.digest[:16]}")
    for each in found.comparisons:
        mark = "✗" if each.problems else "✓"
        click.echo(
            f"{mark} {each.topic}: {each.recorded} recorded, {each.replayed} replayed, "
            f"{each.compared} compared, {each.worst:.3g} {each.unit} at worst"
        )
        for problem in each.problems[:10]:
            click.echo(f"    {problem}", err=True)
        if len(each.problems) > 10:
            click.echo(f"    and {len(each.problems) - 10} more", err=True)
    return 1 if any(each.problems for each in found.comparisons) else 0
