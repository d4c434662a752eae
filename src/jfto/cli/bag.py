"""jfto bag."""

from __future__ import annotations

import re
import time
from pathlib import Path
from typing import Any

import click

from jfto.cli.options import debug_option
from jfto.cli.ros_options import graph_options, session_of

_PATH = click.Path(path_type=Path)


@click.group("bag")
def command() -> None:
    """ROS 2 bags, with or without ROS installed."""


@command.command("info")
@click.argument("bag", type=_PATH)
@click.option("-t", "--topic-name", "names_only", is_flag=True, help="Print topic names only.")
@click.option("-v", "--verbose", is_flag=True, hidden=True)
@debug_option
def info(bag: Path, names_only: bool, verbose: bool, debug: bool) -> int:  # noqa: ARG001
    """Show what BAG holds: a folder, or an .mcap or .db3 file. Reads unfinished recordings too."""
    from jfto.bag.info_text import info_text
    from jfto.bag.reader import Bag

    facts = Bag(bag).facts
    if names_only:
        for topic in facts.topics:
            click.echo(topic.name)
        return 0
    click.echo(info_text(facts))
    if not facts.complete:
        click.echo(f"{bag}: the recording was not finished; this is what was recovered.", err=True)
    return 0


@command.command("record")
@click.argument("topics", nargs=-1)
@click.option("--topics", "more_topics", multiple=True, metavar="TOPIC", help="Record this topic.")
@click.option("-a", "--all", "everything", is_flag=True, help="Record all topics.")
@click.option("-e", "--regex", metavar="REGEX", help="Record topics that match.")
@click.option("-x", "--exclude-topics", "excluded", multiple=True, metavar="TOPIC")
@click.option("--include-hidden-topics", "hidden", is_flag=True)
@click.option("-o", "--output", "output", type=_PATH, metavar="DIR", help="Folder to make.")
@click.option("--compress", is_flag=True, help="Compress the messages with zstd.")
@graph_options
@debug_option
def record(
    topics: tuple[str, ...],
    output: Path | None,
    spin_time: float,
    debug: bool,  # noqa: ARG001
    **choices: Any,
) -> int:
    """Record TOPICS, those that appear later included, until interrupted.

    An mcap bag of version 9 that `ros2 bag` plays. A kill costs no more than the last second.
    """
    from jfto.bag.record import NODE_NAME, Choice, Recording
    from jfto.bag.recorder import BagRecorder

    chosen = Choice(
        topics=(*topics, *choices["more_topics"]),
        pattern=_pattern(choices["regex"]),
        everything=choices["everything"],
        hidden=choices["hidden"],
        excluded=choices["excluded"],
    )
    if not (chosen.topics or chosen.pattern or chosen.everything):
        click.echo(
            "[ERROR] [ros2bag]: Need to specify at least one option out of --all, --topics or "
            "--regex",
            err=True,
        )
        return 1
    path = output or Path(time.strftime("rosbag2_%Y_%m_%d-%H_%M_%S"))
    if path.exists():
        click.echo(f"[ERROR] [ros2bag]: Output folder '{path}' already exists.", err=True)
        return 1
    with session_of(spin_time, NODE_NAME) as session:
        recorder = BagRecorder(path, compress=choices["compress"])
        try:
            Recording(session, recorder, chosen).run()
        finally:
            recorder.close()
    click.echo(f"{path}: {recorder.message_count} messages", err=True)
    return 0


def _pattern(text: str | None) -> re.Pattern[str] | None:
    try:
        return None if text is None else re.compile(text)
    except re.error as error:
        raise click.BadParameter(str(error), param_hint="--regex") from None


@command.command("play")
@click.argument("bag", type=_PATH)
@click.argument("more", nargs=-1, metavar="[TOPIC]... [OLD:=NEW]...")
@click.option(
    "-r", "--rate", type=click.FloatRange(0, min_open=True), default=1.0, show_default=True
)
@click.option("--topics", multiple=True, metavar="TOPIC", help="Play this topic; more may follow.")
@click.option("--exclude-topics", "excluded", multiple=True, metavar="TOPIC")
@click.option(
    "--clock",
    "clock_hz",
    type=click.FloatRange(0, min_open=True),
    is_flag=False,
    flag_value=40.0,
    metavar="[HZ]",
    help="Publish /clock, 40 times a second if not told otherwise.",
)
@click.option("--start-offset", type=click.FloatRange(0), default=0.0, metavar="SECONDS")
@click.option("-d", "--delay", type=click.FloatRange(0), default=0.0, metavar="SECONDS")
@click.option("-l", "--loop", is_flag=True, help="Begin anew at the end.")
@click.option("-m", "--remap", multiple=True, metavar="OLD:=NEW")
@graph_options
@debug_option
def play(bag: Path, spin_time: float, debug: bool, **choices: Any) -> int:  # noqa: ARG001
    """Publish the messages of BAG with the QoS that was recorded."""
    from jfto.bag.player import NODE_NAME, Player, PlayOptions
    from jfto.bag.reader import Bag
    from jfto.ros_cli.session import Stopped

    rules = [*choices["remap"], *(each for each in choices["more"] if ":=" in each)]
    topics = [*choices["topics"], *(each for each in choices["more"] if ":=" not in each)]
    options = PlayOptions(
        rate=choices["rate"],
        topics=frozenset(topics),
        excluded=frozenset(choices["excluded"]),
        remap=_remap(rules),
        clock_hz=choices["clock_hz"],
        start_offset_s=choices["start_offset"],
        delay_s=choices["delay"],
        loop=choices["loop"],
    )
    opened = Bag(bag)
    with session_of(spin_time, NODE_NAME) as session:
        player = Player(session, opened, options)
        try:
            player.run()
        except Stopped:
            # As in ros2 bag, an end before the end is no failure.
            return 0
    return 0


def _remap(rules: list[str]) -> dict[str, str]:
    pairs = [rule.partition(":=") for rule in rules]
    for old, _, new in pairs:
        if not (old and new):
            raise click.BadParameter(f"'{old}' is not OLD:=NEW.", param_hint="--remap")
    return {old: new for old, _, new in pairs}
