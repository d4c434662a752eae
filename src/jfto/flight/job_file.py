"""The job of a flight in its directory, so that another process can go on with it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from jfto.flight.job import FlightJob
from jfto.flight.settings import ConductSettings
from jfto.supervision.graph import environment
from jfto.supervision.graph_table import FLIGHT_STATE_NAME, JOB_NAME, PARAMETERS_NAME
from jfto.supervision.process import NodeCommand
from jfto_mavlink.fleet.watched_flight import is_over
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import FileKind, read_record, write_record
from jfto_msgs_py.records.plan import Plan

_KIND = FileKind(
    "flight job", "Name the directory of a jfto run.", format="jfto-flight-job", version=1
)


@dataclass(frozen=True)
class _Node:
    """A process of the graph: what is started, and how long it may take to end, s."""

    name: str
    command: tuple[str, ...]
    patience_s: float


@dataclass(frozen=True)
class _Job:
    """A `FlightJob` without its plan and its directory."""

    title: str
    simulated: bool
    speedup: float
    nodes: tuple[_Node, ...]


def write_job(job: FlightJob) -> None:
    """Write a job into its directory; raises InputError."""
    nodes = tuple(
        _Node(node.name, tuple(map(str, node.command)), node.patience_s) for node in job.nodes
    )
    kept = _Job(job.title, job.simulated, job.settings.speedup, nodes)
    write_record(kept, job.directory / JOB_NAME, _KIND)


def resumed_job(directory: Path, plan: Plan) -> FlightJob:
    """The job of a flight that goes on though whoever conducted it is gone.

    Raises InputError where there is none, it is over, or its vehicles were simulated by the graph
    that ended.
    """
    path = directory / JOB_NAME
    if not path.exists():
        raise InputError(f"{directory}: no flight was begun there that could be resumed.")
    kept = read_record(path, _Job, _KIND)
    # Parameters that are still to be put back are a reason to look at vehicles that are down.
    unfinished = (directory / PARAMETERS_NAME).exists() and not kept.simulated
    if is_over(directory / FLIGHT_STATE_NAME) and not unfinished:
        raise InputError(
            f"{directory}: its flight is over: all were down, nothing is left to resume. jfto "
            f"report {directory} tells of it."
        )
    if kept.simulated:
        raise InputError(
            f"{directory}: its vehicles were simulated and ended with their graph. Nothing is left "
            f"to resume; jfto report {directory} says how far they came."
        )
    nodes = tuple(
        NodeCommand(each.name, each.command, environment(), each.patience_s) for each in kept.nodes
    )
    settings = replace(
        ConductSettings(plan_s=plan.landed_s or plan.slots.horizon_s, speedup=kept.speedup),
        resume=True,
    )
    return FlightJob(kept.title, directory, plan, nodes, settings, simulated=False)
