"""Which processes make up the graph of a scenario."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import jfto
from jfto.supervision.process import NodeCommand

LIFT_OFF_NAME = "lift_off.json"
ENERGY_NAME = "energy.json"


@dataclass(frozen=True)
class GraphOptions:
    """What is run and with which parameters of its own, besides the scenario's.

    `plan` is the plan file, which the planner makes if it is not there; `parameters` holds further
    ones by node. What must outlive a restart, lift-off and energy, is kept in `directory`.
    """

    scenario: Path
    directory: Path
    plan: Path
    play_poses: bool = False
    use_sim_time: bool = False
    parameters: Mapping[str, Mapping[str, object]] | None = None


def graph_commands(options: GraphOptions) -> list[NodeCommand]:
    """The graph's processes in the order in which they are started."""
    own: dict[str, dict[str, object]] = {
        "planner_node": {
            "plan_file": options.plan,
            "state_file": options.directory / LIFT_OFF_NAME,
        },
        "topology_node": {},
        "power_node": {"state_file": options.directory / ENERGY_NAME},
    }
    if options.play_poses:
        own["pose_player"] = {}
    for name, values in (options.parameters or {}).items():
        # A section for a node that is not run is for other backends.
        if name in own:
            own[name].update(values)
    return [NodeCommand(name, _command(name, options, own[name]), _environment()) for name in own]


def _command(name: str, options: GraphOptions, own: Mapping[str, object]) -> Sequence[str]:
    # The options come after the file: both belong to the key /**, where the later value wins.
    command = [sys.executable, "-m", "jfto.nodes", name, "--ros-args"]
    command += ["--params-file", str(options.scenario)]
    values = {"use_sim_time": options.use_sim_time, **own}
    for key, value in values.items():
        command += ["-p", f"{key}:={_text(value)}"]
    return command


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.9f}"
    return str(value)


def _environment() -> dict[str, str]:
    """The environment, with this very jfto first on the path."""
    source = str(Path(jfto.__file__).parents[1])
    known = os.environ.get("PYTHONPATH", "")
    path = os.pathsep.join([source, known]) if known else source
    return {**os.environ, "PYTHONPATH": path, "PYTHONUNBUFFERED": "1"}
