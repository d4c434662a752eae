"""Which processes make up the graph of a scenario."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import jfto
from jfto.supervision.process import NodeCommand

LIFT_OFF_NAME = "lift_off.json"
ENERGY_NAME = "energy.json"
FLIGHT_NAME = "flight_state.json"
BAG_NAME = "bag"
TLOGS = "tlogs"
# In the order in which they are started: the recorder hears all, and the bridge goes first at the
# end. Its place, counted from 10, is the exit status of a graph that gave one up.
EXIT_STATUSES = {
    "planner_node": 10,
    "topology_node": 11,
    "power_node": 12,
    "pose_player": 13,
    "mavlink_bridge": 14,
    "simulated_fleet": 15,
    "recorder": 16,
    "radio_node": 17,
}


@dataclass(frozen=True)
class GraphOptions:
    """What is run and with which parameters of its own, besides the scenario's.

    `plan` is the plan file, which the planner makes if it is not there; `parameters` holds further
    ones by node. What must outlive a restart, lift-off, energy and flight, is kept in `directory`.

    `play_poses` has planned positions played as poses; `bridge` has vehicles spoken with, and
    `simulate` simulates them, whose time the whole graph then keeps. `record` writes a bag.
    """

    scenario: Path
    directory: Path
    plan: Path
    play_poses: bool = False
    bridge: bool = False
    simulate: bool = False
    record: bool = False
    use_sim_time: bool = False
    parameters: Mapping[str, Mapping[str, object]] | None = None

    @property
    def sim_time(self) -> bool:
        """Whether the nodes take the time from /clock."""
        return self.use_sim_time or self.simulate


def graph_commands(options: GraphOptions) -> list[NodeCommand]:
    """The graph's processes in the order in which they are started."""
    own: dict[str, dict[str, object]] = {}
    if options.simulate:
        own["simulated_fleet"] = {"plan_file": options.plan}
    own["planner_node"] = {
        "plan_file": options.plan,
        "state_file": options.directory / LIFT_OFF_NAME,
    }
    own["topology_node"] = {}
    own["power_node"] = {"state_file": options.directory / ENERGY_NAME}
    if options.simulate:
        # Real radios are set aboard, each by a node on its UAV's companion.
        own["radio_node"] = {}
    if options.play_poses:
        own["pose_player"] = {}
    if options.bridge:
        own["mavlink_bridge"] = {
            "plan_file": options.plan,
            "log_directory": options.directory / TLOGS,
            "state_file": options.directory / FLIGHT_NAME,
        }
    for name, values in (options.parameters or {}).items():
        # A section for a node that is not run is for other backends.
        if name in own:
            own[name].update(values)
    commands = [
        NodeCommand(name, _command(name, options, own[name]), _environment()) for name in own
    ]
    if options.record:
        commands.insert(0, NodeCommand("recorder", _recorder(options), _environment()))
    return commands


def _command(name: str, options: GraphOptions, own: Mapping[str, object]) -> Sequence[str]:
    # The options come after the file: both belong to the key /**, where the later value wins.
    command = [sys.executable, "-m", "jfto.nodes", name, "--ros-args"]
    command += ["--params-file", str(options.scenario)]
    values = {"use_sim_time": options.sim_time, **own}
    for key, value in values.items():
        command += ["-p", f"{key}:={_text(value)}"]
    return command


def _recorder(options: GraphOptions) -> Sequence[str]:
    from jfto_msgs_py.ros.topics import RECORDED

    command = [sys.executable, "-m", "jfto", "bag", "record", "--regex", RECORDED]
    command += ["--output", str(options.directory / BAG_NAME), "--next-free"]
    # As the nodes have them, for a replay: the scenario file lacks what only this run has.
    command += ["--parameters"]
    return [*command, "--use-sim-time"] if options.sim_time else command


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.9f}"
    if isinstance(value, tuple):
        return json.dumps(list(value))
    return str(value)


def _environment() -> dict[str, str]:
    """The environment, with this very jfto first on the path."""
    source = str(Path(jfto.__file__).parents[1])
    known = os.environ.get("PYTHONPATH", "")
    path = os.pathsep.join([source, known]) if known else source
    return {**os.environ, "PYTHONPATH": path, "PYTHONUNBUFFERED": "1"}
