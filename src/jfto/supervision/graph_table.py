"""The one table of the graph: its processes and all their parameters.

The supervisor and the launch file both read it. It imports no library, since `ros2 launch` reads it
in an interpreter that has ROS 2 and little else.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from jfto_msgs_py.ros.topics import RECORDED

LIFT_OFF_NAME = "lift_off.json"
ENERGY_NAME = "energy.json"
FLIGHT_STATE_NAME = "flight_state.json"
# What the bridge keeps beside that of a flight on streamed curves.
GUIDED_NAMES = ("guided_flight.json", "guided_curves.json")
JOB_NAME = "flight_job.json"
PARAMETERS_NAME = "parameters.json"
PREFLIGHT_NAME = "preflight.json"
BAG_NAME = "bag"
TLOGS = "tlogs"
RECORDER = "recorder"
# Each process's place, counted from 10, is the exit status of a graph that gave it up.
EXIT_STATUSES = {
    "planner_node": 10,
    "topology_node": 11,
    "power_node": 12,
    "pose_player": 13,
    "mavlink_bridge": 14,
    "simulated_fleet": 15,
    RECORDER: 16,
    "radio_node": 17,
}
# A scenario's words on who flies; those of whoever starts the graph replace them.
WHO_FLIES = ("roster", "endpoints", "key_file", "speedup", "vehicle_stamps")

# Where neither the scenario nor whoever starts the graph says it: seconds until lift-off for those
# who do not wait for the fleet's, and slots solved ahead.
START_DELAY_S = 10.0
HORIZON_SLOTS = 10

Parameters = Mapping[str, Mapping[str, object]]


@dataclass(frozen=True)
class Vehicles:
    """Who flies: parameters by node. `given` ones win over the scenario's, `suited` ones do not."""

    simulated: bool
    given: Parameters
    suited: Parameters = field(default_factory=dict)


@dataclass(frozen=True)
class GraphOptions:
    """What is run, and with which parameters besides those of the file `scenario`.

    `plan` is the plan file, which the planner makes if it is not there; None: no planner. What must
    outlive a restart, lift-off, energy and flight, is kept in `directory`. `vehicles` are spoken
    with, and simulated where they say so: the whole graph then keeps their time. `play_poses` has
    planned positions played as poses, `record` writes a bag.

    Parameters by node: `sections` are the scenario's own for single nodes; `suited` ones hold where
    those say nothing, `given` ones whatever they say.
    """

    scenario: Path
    directory: Path
    plan: Path | None
    vehicles: Vehicles | None = None
    play_poses: bool = False
    record: bool = False
    use_sim_time: bool = False
    sections: Parameters = field(default_factory=dict)
    suited: Parameters = field(default_factory=dict)
    given: Parameters = field(default_factory=dict)

    @property
    def simulate(self) -> bool:
        """Whether the vehicles are simulated."""
        return self.vehicles is not None and self.vehicles.simulated

    @property
    def sim_time(self) -> bool:
        """Whether the nodes take the time from /clock."""
        return self.use_sim_time or self.simulate


def suited_to(start_delay_s: float, horizon_slots: int) -> Parameters:
    """What a graph that is started by hand has unless its scenario says otherwise."""
    return {
        "planner_node": {"start_delay_s": start_delay_s},
        "topology_node": {"horizon_slots": horizon_slots},
    }


@dataclass(frozen=True)
class NodeRow:
    """A node: its name, which is that of its executable too, and its parameters."""

    name: str
    parameters: Mapping[str, object]


def graph_table(options: GraphOptions) -> list[NodeRow]:
    """The graph's nodes in the order in which they are started, the bridge last."""
    kept = options.directory
    own: dict[str, dict[str, object]] = {}
    if options.simulate:
        own["simulated_fleet"] = {"plan_file": options.plan}
    if options.plan is not None:
        own["planner_node"] = {"plan_file": options.plan, "state_file": kept / LIFT_OFF_NAME}
    own["topology_node"] = {}
    own["power_node"] = {"state_file": kept / ENERGY_NAME}
    if options.simulate:
        # Real radios are set aboard, each by a node on its UAV's companion.
        own["radio_node"] = {}
    if options.play_poses:
        own["pose_player"] = {}
    if options.vehicles is not None:
        own["mavlink_bridge"] = {
            "plan_file": options.plan,
            "log_directory": kept / TLOGS,
            "state_file": kept / FLIGHT_STATE_NAME,
            "parameters_file": kept / PARAMETERS_NAME,
            "preflight_file": kept / PREFLIGHT_NAME,
        }
    return [
        NodeRow(name, {"use_sim_time": options.sim_time, **values, **_chosen(name, options)})
        for name, values in own.items()
    ]


def recorder_arguments(options: GraphOptions) -> list[str]:
    """What `jfto` is called with to record the graph; started first, since it hears all."""
    # With the nodes' parameters, for a replay: the scenario file lacks what only this run has.
    arguments = ["bag", "record", "--regex", RECORDED, "--next-free", "--parameters"]
    arguments += ["--output", str(options.directory / BAG_NAME)]
    return [*arguments, "--use-sim-time"] if options.sim_time else arguments


def _chosen(name: str, options: GraphOptions) -> dict[str, object]:
    """A node's parameters as the scenario and those who start the graph want them."""
    section = dict(options.sections.get(name, {}))
    layers: list[Parameters] = [options.suited]
    if options.vehicles is not None:
        if name == "mavlink_bridge":
            section = {key: value for key, value in section.items() if key not in WHO_FLIES}
        layers += [options.vehicles.suited, {name: section}, options.vehicles.given]
    else:
        layers.append({name: section})
    chosen: dict[str, object] = {}
    for layer in [*layers, options.given]:
        chosen.update(layer.get(name, {}))
    return chosen
