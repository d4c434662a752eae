"""The graph's table as commands for the supervisor."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import jfto
from jfto.supervision.graph_table import (
    RECORDER,
    GraphOptions,
    graph_table,
    recorder_arguments,
)
from jfto.supervision.process import NodeCommand

# A recorder that is made to end leaves a bag without an index: on a busy computer it takes a while.
RECORDER_PATIENCE_S = 30.0


def graph_commands(options: GraphOptions) -> list[NodeCommand]:
    """The graph's processes in the order in which they are started."""
    commands = [
        NodeCommand(row.name, _command(row.name, options.scenario, row.parameters), environment())
        for row in graph_table(options)
    ]
    if options.record:
        recorder = [sys.executable, "-m", "jfto", *recorder_arguments(options)]
        commands.insert(0, NodeCommand(RECORDER, recorder, environment(), RECORDER_PATIENCE_S))
    return commands


def _command(name: str, scenario: Path, parameters: Mapping[str, object]) -> Sequence[str]:
    # The options come after the file: both belong to the key /**, where the later value wins.
    command = [sys.executable, "-m", "jfto.nodes", name, "--ros-args"]
    command += ["--params-file", str(scenario)]
    for key, value in parameters.items():
        command += ["-p", f"{key}:={_text(value)}"]
    return command


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.9f}"
    if isinstance(value, tuple):
        return json.dumps(list(value))
    return str(value)


def environment() -> dict[str, str]:
    """Environment of this process, with this very jfto first on the path."""
    source = str(Path(jfto.__file__).parents[1])
    known = os.environ.get("PYTHONPATH", "")
    path = os.pathsep.join([source, known]) if known else source
    return {**os.environ, "PYTHONPATH": path, "PYTHONUNBUFFERED": "1"}
