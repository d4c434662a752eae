"""Options and the session that all commands on the ROS graph share."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from jfto.ros_cli.session import Session

_F = TypeVar("_F", bound=Callable[..., Any])


def graph_options(function: _F) -> _F:
    """--spin-time, and ros2cli's --no-daemon, which changes nothing: there is no daemon."""
    function = click.option("--no-daemon", is_flag=True, expose_value=False, hidden=True)(function)
    return click.option(
        "--spin-time",
        type=float,
        default=0.5,
        show_default=True,
        metavar="SECONDS",
        help="Listen at least this long for nodes.",
    )(function)


@contextlib.contextmanager
def session_of(
    spin_time_s: float, node_name: str | None = None, *, sim_time: bool = False
) -> Iterator[Session]:
    """Session that click's context carries, or a new one; a signal ends it without a word."""
    from jfto.ros_cli.session import Session, Stopped, open_session

    given = click.get_current_context().find_object(Session)
    if given is not None:
        yield given
        return
    try:
        with open_session(spin_time_s, node_name, sim_time=sim_time) as session:
            yield session
    except Stopped as stopped:
        raise click.exceptions.Exit(stopped.status) from None
