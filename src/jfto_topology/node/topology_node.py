"""C-TOP in the graph: from plans and measured poses to adjacency and power intervals."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

from std_msgs.msg import Float64MultiArray, UInt8MultiArray
from visualization_msgs.msg import MarkerArray

from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.air import decode_air_array, decode_energy_left
from jfto_msgs_py.ros.core_node import CoreNode, fleet_inputs
from jfto_msgs_py.ros.diagnostics import Status
from jfto_msgs_py.ros.intake import Input
from jfto_msgs_py.ros.network import encode_adjacency, encode_power_intervals
from jfto_msgs_py.scenario import Scenario
from jfto_topology.core import TopologyCore, TopologyOutputs, topology_core
from jfto_topology.horizon import HorizonTopology
from jfto_topology.node.markers import FleetMarkers
from jfto_topology.node.statuses import about_fleet, about_uav
from jfto_topology.node.terrain_mesh import encode_terrain
from jfto_topology.options import TopologyOptions
from jfto_world.motion.fleet_tracking import AHEAD_S, AHEAD_SIMULATED_S

if TYPE_CHECKING:
    from jfto_world.terrain import Dem


class TopologyNode(CoreNode[TopologyOptions, TopologyOutputs]):
    """Publishes the topology of the slots ahead as soon as a slot's poses have come.

    `dem_of` knows a scenario's terrain, for drawing it.
    """

    core: TopologyCore

    def __init__(self, dem_of: Callable[[Scenario], Dem] | None = None, **arguments: Any) -> None:
        self._dem_of = dem_of
        super().__init__("topology_node", TopologyOptions, **arguments)

    def build(self, scenario: Scenario, options: TopologyOptions) -> None:
        """The core, publishers and subscriptions."""
        ahead_s = AHEAD_SIMULATED_S if self.time_is_simulated else AHEAD_S
        self.core = topology_core(scenario, options, ahead_s)
        kinds = {
            topics.ADJACENCY: UInt8MultiArray,
            topics.POWER_INTERVAL: Float64MultiArray,
            topics.MARKERS: MarkerArray,
        }
        self._ground = None
        if options.terrain_cell_m and self._dem_of is not None:
            kinds[topics.TERRAIN] = MarkerArray
            dem = self._dem_of(scenario)
            self._ground = encode_terrain(dem, options.terrain_cell_m, self.now_ns())
        self._publisher_of = {
            topic: self.create_lifecycle_publisher(kind, topic, qos.latched())
            for topic, kind in kinds.items()
        }
        self._drawing: FleetMarkers | None = None
        self.connect(self.core, topology_inputs(self.core))

    def activated(self) -> None:
        """Solve what is due."""
        if self._ground is not None:
            self._publisher_of[topics.TERRAIN].publish(self._ground)
        self.core.listen()
        self.step()

    def publish(self, made: TopologyOutputs) -> None:
        """Adjacency and intervals; then markers, and what the operator is to know."""
        for topic, message in topology_messages(made, self.now_ns()):
            self._publisher_of[topic].publish(message)
        if made.solved is not None and self.core.settings.options.markers:
            self._draw(made.solved)
        for event in self.core.review(self.now_ns()):
            self.announce(event)

    def _draw(self, solved: HorizonTopology) -> None:
        scene = self.core.scene(solved, self.now_ns())
        if self._drawing is None or self._drawing.paths_m is not scene.paths_m:
            self._drawing = FleetMarkers(scene.paths_m)
        self._publisher_of[topics.MARKERS].publish(self._drawing.draw(scene))

    def statuses(self, now_ns: int) -> list[Status]:
        """Who is linked how well, whose pose is stale, what was malformed, what is to come."""
        core, facts = self.core, self.intake.facts
        margins_db = None if core.solved is None else core.margins_db(core.solved)
        return [
            about_fleet(core, facts("/jfto/")),
            *(about_uav(core, uav, margins_db, facts(f"/{uav}/"), now_ns) for uav in core.uav_ids),
        ]


def topology_inputs(core: TopologyCore) -> list[Input]:
    """What the core is fed with: trajectories and poses of the fleet, energy left, measured air."""
    kind, left, gain = Float64MultiArray, topics.ENERGY_LEFT, topics.AIR_GAIN
    inputs = fleet_inputs(core, core.uav_ids)
    inputs.append(Input(kind, left, qos.latched(), decode_energy_left, core.take_energy))
    if core.settings.options.learn_loss:
        decode = partial(decode_air_array, rank=2)
        inputs.append(Input(kind, gain, qos.default(), decode, core.take_gain))
    return inputs


def topology_messages(made: TopologyOutputs, _now_ns: int) -> Iterator[tuple[str, Any]]:
    """Topics and messages of a step's outputs, those that other nodes act on."""
    if made.solved is not None:
        yield topics.ADJACENCY, encode_adjacency(made.solved.adjacency)
        yield topics.POWER_INTERVAL, encode_power_intervals(made.solved.intervals)
