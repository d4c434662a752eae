"""The nodes that a scenario file may have sections for, and their own parameters."""

from __future__ import annotations

from jfto.pose_player_options import PosePlayerOptions
from jfto.simulated_fleet_options import SimulatedFleetOptions
from jfto_mavlink.options import BridgeOptions
from jfto_msgs_py.scenario import Key
from jfto_msgs_py.scenario.options import option_keys
from jfto_planner.planner_options import PlannerOptions
from jfto_power.options import PowerOptions, RadioOptions
from jfto_topology.options import TopologyOptions

NODE_OPTIONS: dict[str, dict[str, Key]] = {
    "planner_node": option_keys(PlannerOptions),
    "topology_node": option_keys(TopologyOptions),
    "power_node": option_keys(PowerOptions),
    "radio_node": option_keys(RadioOptions),
    "pose_player": option_keys(PosePlayerOptions),
    "mavlink_bridge": option_keys(BridgeOptions),
    "simulated_fleet": option_keys(SimulatedFleetOptions),
}
