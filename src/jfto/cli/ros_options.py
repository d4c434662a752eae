"""What all commands on the ROS graph share: options, the session, how a signal ends them."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from jfto.ros_cli.graph import NamesAndTypes
    from jfto.ros_cli.session import Session


def graph_command(function: Callable[..., int | None]) -> Callable[..., int]:
    """Give a command --spin-time and a session as its first argument; no status means 0."""

    @functools.wraps(function)
    def run(*, spin_time: float, **choices: Any) -> int:
        with session_of(spin_time) as session:
            return function(session, **choices) or 0

    return spin_option(run)


def spin_option(function: Callable[..., int]) -> Callable[..., int]:
    """--spin-time, and ros2cli's --no-daemon, which changes nothing: there is no daemon."""
    function = click.option("--no-daemon", is_flag=True, expose_value=False, hidden=True)(function)
    return click.option(
        "--spin-time",
        type=float,
        default=1.0,
        show_default=True,
        metavar="SECONDS",
        help="Listen at least this long for nodes.",
    )(function)


def list_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """What `topic list` and `service list` take."""
    for names, text in (
        (("-a", "--all", "hidden"), "Show hidden ones too."),
        (("-c", "--count", "count_only"), "Show how many only."),
        (("-t", "--show-types"), "Show the types too."),
    ):
        function = click.option(*names, is_flag=True, help=text)(function)
    return function


def print_names(found: NamesAndTypes, *, show_types: bool, count_only: bool) -> None:
    """Print topics or services, one a line, or their number."""
    if count_only:
        click.echo(len(found))
        return
    for name, kinds in found:
        click.echo(f"{name} [{', '.join(kinds)}]" if show_types else name)


@contextlib.contextmanager
def session_of(spin_time_s: float = 0.0, node_name: str | None = None) -> Iterator[Session]:
    """Session that click's context carries, or a new one; a signal ends it without a word.

    Raises RosMissingError where there is no ROS 2.
    """
    from jfto_msgs_py.ros.installation import require_ros

    require_ros()
    from jfto.ros_cli.session import Session, Stopped, open_session

    given = click.get_current_context().find_object(Session)
    if given is not None:
        yield given
        return
    try:
        with open_session(spin_time_s, node_name) as session:
            yield session
    except Stopped as stopped:
        raise click.exceptions.Exit(stopped.status) from None
