"""C-TOP in the graph: from plans and measured poses to adjacency and power intervals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Float64MultiArray, UInt8MultiArray
from trajectory_msgs.msg import MultiDOFJointTrajectory
from visualization_msgs.msg import MarkerArray

from jfto_msgs_py.clock_watch import ClockWatch
from jfto_msgs_py.errors import InputError, MessageError
from jfto_msgs_py.records.event import WARN, Event
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.air import decode_air_array
from jfto_msgs_py.ros.diagnostics import Status
from jfto_msgs_py.ros.energy import decode_energy_left
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.network import encode_adjacency, encode_power_intervals
from jfto_msgs_py.ros.vehicle import decode_trajectory
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.units import dbm_to_w, ratio_to_db
from jfto_topology.fleet_events import FleetEvents
from jfto_topology.flight_watch import FlightWatch
from jfto_topology.horizon import HorizonSettings, HorizonTopology, TopologyHorizon
from jfto_topology.links import SPREADS, Links
from jfto_topology.node.markers import FleetMarkers, Scene
from jfto_topology.node.statuses import Heard, about_node, about_uav
from jfto_topology.node.terrain_mesh import encode_terrain
from jfto_topology.options import TopologyOptions
from jfto_world.motion.fleet_plan import FleetPlan
from jfto_world.motion.fleet_prediction import FleetPrediction
from jfto_world.radio import LossEstimate, make_channel, pairwise_distances

if TYPE_CHECKING:
    from jfto_world.terrain import Dem

# How soon to look again for a fleet that nobody hears of, at least.
_RETRY_S = 0.1


class TopologyNode(GraphNode[TopologyOptions]):
    """Publishes the topology of the slots ahead as soon as a slot's poses have come.

    `dem_of` knows a scenario's terrain, for drawing it.
    """

    def __init__(self, dem_of: Callable[[Scenario], Dem] | None = None, **arguments: Any) -> None:
        self._dem_of = dem_of
        self._horizon: TopologyHorizon | None = None
        self._last: HorizonTopology | None = None
        self._since_ns = 0
        self._clock_watch = ClockWatch()
        super().__init__("topology_node", TopologyOptions, **arguments)

    def build(self, scenario: Scenario, options: TopologyOptions) -> None:
        """Subscriptions per UAV, publishers, and the timer that ends waiting."""
        radio, network = scenario.radio.record(), scenario.network
        self._options, self._mission = options, scenario.mission
        self._prediction = FleetPrediction()
        self._plan = FleetPlan(scenario.fleet.ids)
        p_max_w = dbm_to_w(np.array(scenario.fleet.p_max_dbm))
        self._links = Links(
            make_channel(radio),
            dict(zip(scenario.fleet.ids, p_max_w.tolist(), strict=True)),
            float(dbm_to_w(radio.sensitivity_dbm)),
            network.k_min,
            network.delta,
            options.margin_db,
        )
        self._losses = LossEstimate(self._links.channel)
        self._drawing: FleetMarkers | None = None
        self._fleet_events = FleetEvents(self._prediction)
        self._watch = FlightWatch(
            self._prediction, self._links, scenario.mission.d_min_m, options.watch_slots
        )
        self._left_j: dict[str, float] = {}
        self.create_subscription(
            Float64MultiArray, topics.ENERGY_LEFT, self._on_energy, qos.latched()
        )
        if options.learn_loss:
            self.create_subscription(
                Float64MultiArray, topics.AIR_GAIN, self._on_gain, qos.default()
            )
        for uav in scenario.fleet.ids:
            self.create_subscription(
                MultiDOFJointTrajectory,
                topics.trajectory(uav),
                partial(self._on_trajectory, uav),
                qos.latched(),
            )
            self.create_subscription(
                PoseStamped, topics.pose(uav), partial(self._on_pose, uav), qos.sensor()
            )
        self._adjacency = self.create_lifecycle_publisher(
            UInt8MultiArray, topics.ADJACENCY, qos.latched()
        )
        self._intervals = self.create_lifecycle_publisher(
            Float64MultiArray, topics.POWER_INTERVAL, qos.latched()
        )
        self._markers = self.create_lifecycle_publisher(MarkerArray, topics.MARKERS, qos.latched())
        self._terrain, self._ground = None, None
        if options.terrain_cell_m and self._dem_of is not None:
            self._terrain = self.create_lifecycle_publisher(
                MarkerArray, topics.TERRAIN, qos.latched()
            )
            self._ground = encode_terrain(
                self._dem_of(scenario), options.terrain_cell_m, self.now_ns()
            )
        self._deadline = self.create_timer(3600.0, self._step)
        self._deadline.cancel()

    def released(self) -> None:
        """Forget plans and poses."""
        self._horizon = self._last = None
        self._since_ns = 0

    def activated(self) -> None:
        """Solve what is due."""
        self._since_ns = 0
        if self._terrain is not None:
            self._terrain.publish(self._ground)
        self._step()

    def _on_trajectory(self, uav: str, message: Any) -> None:
        trajectory = self.intake.take(topics.trajectory(uav), decode_trajectory, message)
        if trajectory is None or not self._plan.take(uav, trajectory):
            return
        self._prediction.set_trajectory(uav, trajectory)
        self._horizon = self._drawing = None
        # Plans of one planning begin together; until all are there, the fleet has none.
        if self._plan.complete:
            try:
                self._horizon = self._make_horizon()
            except InputError as error:
                self.intake.refuse(topics.trajectory(uav), MessageError("points", str(error)))
                return
            self._step()

    def _make_horizon(self) -> TopologyHorizon:
        """Slots of the mission over the plan; raises InputError where that makes none."""
        slots, options = self._mission.slot_count, self._options
        duration_s = self._mission.horizon_s or self._plan.duration_s
        settings = HorizonSettings(
            slots,
            duration_s / slots,
            options.horizon_slots,
            options.stale_after_s,
            # A short slot leaves less time to wait.
            min(options.pose_wait_s, 0.5 * duration_s / slots),
        )
        horizon = TopologyHorizon(self._prediction, self._links, settings)
        horizon.left_j = self._left_j
        return horizon

    def _on_pose(self, uav: str, message: Any) -> None:
        self._follow_clock()
        pose = self.take_pose(uav, message)
        if pose is None or not self._prediction.set_pose(uav, pose):
            return
        if self._horizon is not None and self._horizon.due(self.now_ns()):
            self._step()

    def _on_energy(self, message: Any) -> None:
        left_j = self.intake.take(topics.ENERGY_LEFT, decode_energy_left, message)
        if left_j is not None:
            self._left_j.update(left_j)

    def _on_gain(self, message: Any) -> None:
        """Compare what radios hear with the channel, where their UAVs are believed to be."""
        decode = partial(decode_air_array, rank=2)
        heard = self.intake.take(topics.AIR_GAIN, decode, message)
        if heard is None or not set(heard[1]) <= set(self._prediction.uav_ids):
            return
        stamp_ns, uav_ids, gain = heard
        at = self._prediction.positions(uav_ids, np.array([stamp_ns]))[0]
        self._losses.take(stamp_ns, gain, at)
        margin_db = self._options.margin_db + SPREADS * self._losses.spread_db
        self._links = replace(self._links, loss_db=self._losses.loss_db, margin_db=margin_db)
        if self._horizon is not None:
            self._horizon.links = self._links

    def _follow_clock(self) -> None:
        """Forget poses that a clock has stamped which was since set back."""
        back_ns = self._clock_watch.set_back_by_ns(self.now_ns())
        if back_ns:
            self._prediction.forget_poses()
            self._since_ns = 0
            text = f"The clock was set back by {back_ns / 1e9:.1f} s: earlier poses do not count."
            self.announce(Event(WARN, "topology", "", text))

    def _step(self) -> None:
        """Solve and publish if a slot is due; set the timer for when the next must be."""
        self._follow_clock()
        horizon = self._horizon
        if horizon is None or not self.is_active:
            return
        now_ns = self.now_ns()
        self._since_ns = self._since_ns or now_ns
        if horizon.due(now_ns) and self._may_solve(horizon, now_ns):
            found = horizon.solve(now_ns)
            if found is not None:
                self._last = found
                self._publish(found, now_ns)
                self._tell(found, now_ns)
        # At the end of the first wait nothing may have come that could be waited for.
        first_ns = self._since_ns + round(horizon.settings.pose_wait_s * 1e9)
        until_ns = max(horizon.deadline_ns(now_ns), first_ns) - now_ns
        if until_ns <= 0:
            # Overdue, with hardly anybody to reckon with.
            until_ns = round(max(horizon.settings.pose_wait_s, _RETRY_S) * 1e9)
        self._deadline.timer_period_ns = until_ns
        self._deadline.reset()

    def _tell(self, found: HorizonTopology, now_ns: int) -> None:
        slot_count = self._mission.slot_count
        for event in (
            *self._fleet_events.of_slot(found, now_ns),
            *self._watch.look(found, slot_count, now_ns, self._left_j),
        ):
            self.announce(event)

    def _may_solve(self, horizon: TopologyHorizon, now_ns: int) -> bool:
        """Whether UAVs without a fresh pose have had the time to send one since we listen."""
        fresh = self._prediction.fresh(now_ns, horizon.settings.stale_after_s)
        waited_ns = now_ns - self._since_ns
        return (
            len(fresh) == len(self._plan.uav_ids) or waited_ns >= horizon.settings.pose_wait_s * 1e9
        )

    def _publish(self, found: HorizonTopology, now_ns: int) -> None:
        self._adjacency.publish(encode_adjacency(found.adjacency))
        self._intervals.publish(encode_power_intervals(found.intervals))
        if not self._options.markers:
            return
        uav_ids = self._plan.uav_ids
        if self._drawing is None:
            paths_m = {uav: self._plan.trajectory(uav).position_m for uav in uav_ids}
            self._drawing = FleetMarkers(paths_m)
        scene = Scene(
            now_ns,
            self._prediction.positions(uav_ids, np.array([now_ns]))[0],
            found.adjacency.uav_ids,
            found.adjacency.links[0],
            self._margins_db(found),
        )
        self._markers.publish(self._drawing.draw(scene))

    def _margins_db(self, found: HorizonTopology) -> np.ndarray:
        """What each pair could lose in the current slot, weaker end at greatest power, in dB."""
        uav_ids, horizon = found.adjacency.uav_ids, found.adjacency.horizon
        positions = self._prediction.positions(uav_ids, horizon.instants_ns[:1])
        gain = self._links.channel.gain(pairwise_distances(positions))[0]
        power_w = np.array([self._links.p_max_w[uav] for uav in uav_ids])
        weaker_w = np.minimum(power_w[:, None], power_w[None, :])
        return np.asarray(ratio_to_db(weaker_w * gain / self._links.sensitivity_w))

    def statuses(self, now_ns: int) -> list[Status]:
        """Who is linked how well, whose pose is stale, what was malformed, what is to come."""
        last = self._last
        heard = Heard(
            self._prediction,
            last,
            None if last is None else self._margins_db(last),
            self._watch.dangers,
            self._options.stale_after_s,
            self.intake.facts,
        )
        missing = self._plan.missing if self._horizon is None else ()
        uavs = (about_uav(heard, uav, now_ns) for uav in self._plan.uav_ids)
        return [about_node(heard, missing), *uavs]
