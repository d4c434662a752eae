"""jfto service."""

from __future__ import annotations

import click

from jfto.cli.options import debug_option
from jfto.cli.ros_options import graph_options, session_of


@click.group("service")
def command() -> None:
    """Services of a ROS 2 graph, with or without ROS installed."""


@command.command("list")
@click.option("-t", "--show-types", is_flag=True, help="Show the types too.")
@click.option("-c", "--count-services", "count_only", is_flag=True, help="Show how many only.")
@click.option("-a", "--all", "--include-hidden-services", "hidden", is_flag=True)
@graph_options
@debug_option
def list_(spin_time: float, debug: bool, **choices: bool) -> int:  # noqa: ARG001
    """List the services."""
    from jfto.ros_cli.service_calls import list_services

    with session_of(spin_time) as session:
        list_services(session.node, **choices)
    return 0


@command.command("call")
@click.argument("name")
@click.argument("type_name", metavar="TYPE")
@click.argument("values", default="{}")
@click.option("-r", "--rate", type=click.FloatRange(min=0, min_open=True), help="Repeat, in Hz.")
@graph_options
@debug_option
def call(
    name: str,
    type_name: str,
    values: str,
    rate: float | None,
    spin_time: float,
    debug: bool,  # noqa: ARG001
) -> int:
    """Call service NAME of TYPE with VALUES, YAML of the request."""
    from jfto.ros_cli.service_calls import call_service

    with session_of(spin_time) as session:
        call_service(session, name, type_name, values, rate)
    return 0
