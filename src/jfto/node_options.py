"""The nodes that a scenario file may have sections for, and their own parameters."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_mavlink.options import BridgeOptions
from jfto_msgs_py.records.fields import param
from jfto_msgs_py.scenario import Key
from jfto_msgs_py.scenario.options import option_keys
from jfto_planner.options import PlannerOptions
from jfto_power.options import PowerOptions, RadioOptions
from jfto_topology.options import TopologyOptions


@dataclass(frozen=True)
class PosePlayerOptions:
    """The pose player's own parameters."""

    autostart: bool = param(True, "Configure and activate at start.")
    rate_hz: float = param(10.0, "Poses per second and UAV.", unit="Hz", low=0.1, high=1000.0)


@dataclass(frozen=True)
class SimulatedFleetOptions:
    """The simulated fleet's own parameters."""

    autostart: bool = param(True, "Configure and activate at start.")
    plan_file: str = param("", "Plan whose pads they stand on; waited for where there is none yet.")
    endpoint: str = param(
        "udpto:127.0.0.1:14550", "Where all of them send MAVLink to: the bridge's link."
    )
    speedup: float = param(
        1.0, "How much faster than the wall clock, where the graph keeps up.", low=0.1, high=50.0
    )
    start_time_s: float = param(
        0.0,
        "Wall time, seconds since the epoch, at which their time was the same; 0: at start. One "
        "that is kept makes their time go on over a restart.",
        unit="s",
        low=0.0,
    )
    patience_s: float = param(
        10.0,
        "For so long their time waits for a node, or a pose, that falls behind; then it goes on at "
        "real time. 0: it waits for nobody.",
        unit="s",
        low=0.0,
    )
    clock_rate_hz: float = param(
        50.0, "How often /clock is published, by the wall clock.", unit="Hz", low=1.0, high=1000.0
    )
    faults: tuple[str, ...] = param(
        (), "Fault lines carried out at start (docs/how-to/simulator.md)."
    )
    control_port: int = param(
        0, "UDP port that takes fault lines and sets radios; 0: none.", low=0, high=65535
    )


NODE_OPTIONS: dict[str, dict[str, Key]] = {
    "planner_node": option_keys(PlannerOptions),
    "topology_node": option_keys(TopologyOptions),
    "power_node": option_keys(PowerOptions),
    "radio_node": option_keys(RadioOptions),
    "pose_player": option_keys(PosePlayerOptions),
    "mavlink_bridge": option_keys(BridgeOptions),
    "simulated_fleet": option_keys(SimulatedFleetOptions),
}
