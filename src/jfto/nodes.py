"""Entry points of the nodes: they hand functions from room to room and run the process.

`ros2 run jfto topology_node`, or without ROS `python -m jfto.nodes topology_node`.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jfto.supervision.die_with_parent import die_with_parent

if TYPE_CHECKING:
    from jfto_msgs_py.plan import Plan
    from jfto_msgs_py.scenario import Scenario

Arguments = Sequence[str] | None


def use_stand_in_where_needed() -> None:
    """Make `import rclpy` work where ROS 2 is not installed."""
    if importlib.util.find_spec("rclpy") is None:
        import jfto_dds

        jfto_dds.install()


def planner_node(arguments: Arguments = None) -> int:
    """Run the planner node."""
    use_stand_in_where_needed()
    from jfto_planner.planner_node import PlannerNode

    return _run(lambda: PlannerNode(plan_scenario, load_certified), arguments)


def topology_node(arguments: Arguments = None) -> int:
    """Run the topology node."""
    use_stand_in_where_needed()
    from jfto.scenario_terrain import dem_of
    from jfto_topology.topology_node import TopologyNode

    return _run(lambda: TopologyNode(dem_of), arguments)


def power_node(arguments: Arguments = None) -> int:
    """Run the power node."""
    use_stand_in_where_needed()
    from jfto_power.power_node import PowerNode

    return _run(PowerNode, arguments)


def radio_node(arguments: Arguments = None) -> int:
    """Run the radio node."""
    use_stand_in_where_needed()
    from jfto_power.radio_node import RadioNode

    return _run(RadioNode, arguments)


def pose_player(arguments: Arguments = None) -> int:
    """Run the pose player."""
    use_stand_in_where_needed()
    from jfto.pose_player_node import PosePlayerNode

    return _run(PosePlayerNode, arguments)


def mavlink_bridge(arguments: Arguments = None) -> int:
    """Run the bridge to vehicles."""
    use_stand_in_where_needed()
    from jfto.bridge_fleet import open_simulated
    from jfto.scenario_terrain import ground_of
    from jfto_mavlink.mavlink_bridge import MavlinkBridgeNode

    return _run(lambda: MavlinkBridgeNode(open_simulated, ground_of), arguments)


def simulated_fleet(arguments: Arguments = None) -> int:
    """Run simulated vehicles, whose time is that of the graph."""
    use_stand_in_where_needed()
    from jfto.scenario_terrain import dem_of
    from jfto.simulated_fleet_node import SimulatedFleetNode

    return _run(lambda: SimulatedFleetNode(dem_of), arguments)


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
    from jfto.progress import SilentWatcher
    from jfto.scenario_file import LoadedScenario
    from jfto.stages.routes import plan_routes
    from jfto.stages.survey import survey

    class Watcher(SilentWatcher):
        def advance(self, fraction: float, note: str = "") -> None:
            progress(fraction, note)

    watcher = Watcher()
    found = survey(LoadedScenario(scenario, Path("parameters")), watcher)
    return plan_routes(scenario, found, watcher).plan


def load_certified(path: Path) -> Plan:
    """Plan of a file, checked anew."""
    from jfto.stages.routes import read_and_certify

    return read_and_certify(path)


def _run(make: Callable[[], Any], arguments: Arguments) -> int:
    from jfto_msgs_py.ros.run_node import run_node

    return run_node(make, arguments)


def main(arguments: Sequence[str]) -> int:
    """Run the node that the first argument names."""
    if not arguments or arguments[0] not in NODES:
        print(f"Name a node: {', '.join(NODES)}.", file=sys.stderr)
        return 2
    die_with_parent()
    return NODES[arguments[0]](arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
