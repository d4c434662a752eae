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
    from jfto_msgs_py.records.plan import Plan
    from jfto_msgs_py.scenario import Scenario

Arguments = Sequence[str] | None


def planner_node(arguments: Arguments = None) -> int:
    """Run the planner node."""

    def make() -> Any:
        from jfto_planner.node.planner_node import PlannerNode

        return PlannerNode(plan_scenario, load_certified)

    return _run(make, arguments)


def topology_node(arguments: Arguments = None) -> int:
    """Run the topology node."""

    def make() -> Any:
        from jfto.planning.terrain import dem_of
        from jfto_topology.node.topology_node import TopologyNode

        return TopologyNode(dem_of)

    return _run(make, arguments)


def power_node(arguments: Arguments = None) -> int:
    """Run the power node."""

    def make() -> Any:
        from jfto_power.node.power_node import PowerNode

        return PowerNode()

    return _run(make, arguments)


def radio_node(arguments: Arguments = None) -> int:
    """Run the radio node."""

    def make() -> Any:
        from jfto_power.node.radio_node import RadioNode

        return RadioNode()

    return _run(make, arguments)


def pose_player(arguments: Arguments = None) -> int:
    """Run the pose player."""

    def make() -> Any:
        from jfto.nodes.pose_player import PosePlayerNode

        return PosePlayerNode()

    return _run(make, arguments)


def mavlink_bridge(arguments: Arguments = None) -> int:
    """Run the bridge to vehicles."""

    def make() -> Any:
        from jfto.planning.terrain import ground_of
        from jfto_mavlink.node import MavlinkBridgeNode

        return MavlinkBridgeNode(ground_of)

    return _run(make, arguments)


def simulated_fleet(arguments: Arguments = None) -> int:
    """Run simulated vehicles, whose time is that of the graph."""

    def make() -> Any:
        from jfto.nodes.simulated_fleet import SimulatedFleetNode
        from jfto.planning.terrain import known_dem_of

        return SimulatedFleetNode(known_dem_of)

    return _run(make, arguments)


NODES = {
    "planner_node": planner_node,
    "topology_node": topology_node,
    "power_node": power_node,
    "radio_node": radio_node,
    "pose_player": pose_player,
    "mavlink_bridge": mavlink_bridge,
    "simulated_fleet": simulated_fleet,
}


def plan_scenario(scenario: Scenario, progress: Callable[[float, str], None]) -> Plan:
    """Coverage and routes of a scenario whose file names stand by themselves; certified."""
    from jfto.console.progress import Progress
    from jfto.planning.routes import plan_routes
    from jfto.planning.scenario_file import LoadedScenario
    from jfto.planning.survey import survey

    class Told(Progress):
        def advance(self, fraction: float, note: str = "") -> None:
            progress(fraction, note)

    told = Told()
    found = survey(LoadedScenario(scenario, Path("parameters")), told)
    return plan_routes(scenario, found, told).plan


def load_certified(path: Path) -> Plan:
    """Plan of a file, checked anew."""
    from jfto.planning.routes import read_and_certify

    return read_and_certify(path)


def _run(make: Callable[[], Any], arguments: Arguments) -> int:
    try:
        require_ros()
    except RosMissingError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    from jfto_msgs_py.ros.run_node import end_process, run_node

    return end_process(run_node(make, arguments))
