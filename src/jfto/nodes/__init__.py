"""Entry points of the nodes: they hand functions from room to room and run the process.

`ros2 run jfto topology_node`, or without ros2cli `python -m jfto.nodes topology_node`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jfto_msgs_py.ros.installation import RosMissingError, require_ros

if TYPE_CHECKING:
    from jfto.planning.scenario_file import LoadedScenario
    from jfto_mavlink.mission.limits import Ground
    from jfto_msgs_py.records.plan import Plan
    from jfto_msgs_py.scenario import Scenario
    from jfto_world.terrain import Dem


def plan_scenario(scenario: Scenario, progress: Callable[[float, str], None]) -> Plan:
    """Coverage and routes of a scenario whose file names stand by themselves; certified."""
    from jfto.console.progress import Progress
    from jfto.planning.routes import plan_routes
    from jfto.planning.survey import survey

    class Told(Progress):
        def advance(self, fraction: float, note: str = "") -> None:
            progress(fraction, note)

    told = Told()
    return plan_routes(scenario, survey(_loaded(scenario), told), told).plan


def load_certified(path: Path) -> Plan:
    """Plan of a file, checked anew."""
    from jfto.planning.routes import read_and_certify

    return read_and_certify(path)


def dem_of(scenario: Scenario) -> Dem:
    """Elevation model of a node's scenario; raises TerrainError."""
    from jfto.planning.terrain import load_ground

    return load_ground(_loaded(scenario))


def known_dem_of(scenario: Scenario) -> Dem | None:
    """The same, but None where the terrain is unknown."""
    from jfto.planning.terrain import known_ground

    return known_ground(_loaded(scenario))


def ground_of(scenario: Scenario) -> Ground:
    """Heights that missions must clear over a node's terrain; raises TerrainError."""
    return dem_of(scenario).top_height


def _loaded(scenario: Scenario) -> LoadedScenario:
    """A node's scenario, which comes from no file: what it names stands by itself."""
    from jfto.planning.scenario_file import LoadedScenario

    return LoadedScenario(scenario, Path("parameters"))


# Each node loads within run_node, which knows how to end a process while it does.


def _planner() -> Any:
    from jfto_planner.node.planner_node import PlannerNode

    return PlannerNode(plan_scenario, load_certified)


def _topology() -> Any:
    from jfto_topology.node.topology_node import TopologyNode

    return TopologyNode(dem_of)


def _power() -> Any:
    from jfto_power.node.power_node import PowerNode

    return PowerNode()


def _radio() -> Any:
    from jfto_power.node.radio_node import RadioNode

    return RadioNode()


def _poses() -> Any:
    from jfto.nodes.pose_player import PosePlayerNode

    return PosePlayerNode()


def _bridge() -> Any:
    from jfto_mavlink.node import MavlinkBridgeNode

    return MavlinkBridgeNode(ground_of)


def _fleet() -> Any:
    from jfto.nodes.simulated_fleet import SimulatedFleetNode

    return SimulatedFleetNode(known_dem_of)


def _entry(make: Callable[[], Any]) -> Callable[..., int]:
    """Entry point that runs the node that `make` makes; takes a command line, or has sys.argv."""

    def run(arguments: Sequence[str] | None = None) -> int:
        try:
            require_ros()
        except RosMissingError as error:
            print(error, file=sys.stderr)
            return error.exit_status
        from jfto_msgs_py.ros.run_node import end_process, run_node

        return end_process(run_node(make, arguments))

    return run


planner_node = _entry(_planner)
topology_node = _entry(_topology)
power_node = _entry(_power)
radio_node = _entry(_radio)
pose_player = _entry(_poses)
mavlink_bridge = _entry(_bridge)
simulated_fleet = _entry(_fleet)

NODES = {
    "planner_node": planner_node,
    "topology_node": topology_node,
    "power_node": power_node,
    "radio_node": radio_node,
    "pose_player": pose_player,
    "mavlink_bridge": mavlink_bridge,
    "simulated_fleet": simulated_fleet,
}
