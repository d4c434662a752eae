"""Simulated vehicles in the graph, with the air between them: they fly by MAVLink.

Their time is the graph's.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.time import Time
from rosgraph_msgs.msg import Clock as ClockMessage
from std_msgs.msg import Float64MultiArray

from jfto.simulated_air import fleet_air, hesitations_s
from jfto.simulated_fleet import FleetTime, grounds, pads, vehicle_configs
from jfto.simulated_fleet_options import SimulatedFleetOptions
from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.plan_file import read_plan
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.air import ARRAY_OF_TOPIC, encode_air
from jfto_msgs_py.ros.diagnostics import OK, WARN, Status
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.opening import Opening
from jfto_msgs_py.scenario import Scenario
from jfto_sim.motion.waypoint_nav import warm_up
from jfto_sim.server import ServerSettings, SimServer
from jfto_world.terrain import Dem


class SimulatedFleetNode(GraphNode[SimulatedFleetOptions]):
    """Flies a vehicle per UAV from the pads of the plan file; publishes /clock and /jfto/air/*.

    `dem_of` tells a scenario's terrain, None where nobody knows it. The vehicles outlive
    deactivation: only cleaning up, or the end of the process, takes them out of the air.
    """

    def __init__(
        self, dem_of: Callable[[Scenario], Dem | None] | None = None, **arguments: Any
    ) -> None:
        self._dem_of = dem_of
        self._link: Opening[SimServer] | None = None
        super().__init__("simulated_fleet", SimulatedFleetOptions, **arguments)

    def check(self, scenario: Scenario, options: SimulatedFleetOptions) -> None:
        """Refuse to be without pads."""
        del scenario
        if not options.plan_file:
            raise InputError("plan_file is empty. Name the plan whose pads the vehicles stand on.")

    def build(self, scenario: Scenario, options: SimulatedFleetOptions) -> None:
        """The clock, which runs from now on, with vehicles or without."""
        self._scenario, self._options = scenario, options
        self._fleet_time = FleetTime(options.speedup, options.start_time_s)
        self._last_ns = 0
        self._ticks = self.create_lifecycle_publisher(ClockMessage, topics.CLOCK, qos.clock())
        self._air = {
            topic: self.create_lifecycle_publisher(Float64MultiArray, topic, qos.default())
            for topic in ARRAY_OF_TOPIC
        }
        self._told_ns = 0
        self.create_timer(
            1 / options.clock_rate_hz, self._tick, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def activated(self) -> None:
        """Power the vehicles up as soon as there is a plan."""
        if self._link is None:
            self._link = Opening(self._open, lambda _server: None, self._say)

    def released(self) -> None:
        """Take the vehicles away."""
        link, self._link = self._link, None
        if link is not None:
            link.close()

    def _open(self, stack: ExitStack) -> SimServer:
        """Vehicles on their pads; runs in the link's thread."""
        scenario, options = self._scenario, self._options
        errors = scenario.simulation
        path = Path(options.plan_file)
        if not path.exists():
            raise PlanError(f"{path} is not there yet.")
        plan = read_plan(path)
        dem = None if self._dem_of is None else self._dem_of(scenario)
        # Before the time of power-up is read: an empty compiler cache takes a minute to fill.
        warm_up()
        boot_ns = self._fleet_time.now_ns()
        configs = vehicle_configs(
            pads(plan),
            grounds(plan, dem),
            boot_ns,
            seed=errors.seed,
            gps_noise_m=errors.position_error_m,
            hesitations_s=hesitations_s(len(plan.uavs), errors),
        )
        settings = ServerSettings(
            ((options.endpoint,),) * len(configs),
            options.speedup,
            errors.seed,
            options.faults,
            options.control_port or None,
        )
        server = stack.enter_context(SimServer(configs, settings, fleet_air(plan, errors, dem)))
        self._fleet_time.follow(server, boot_ns)
        count, endpoint = len(configs), options.endpoint
        self.get_logger().info(f"{count} vehicles on their pads send to {endpoint}")
        return server

    def _say(self, note: str) -> None:
        self.get_logger().warning(f"No vehicles: {note}")

    def _tick(self) -> None:
        if not self.is_active:
            return
        self._last_ns = max(self._last_ns, self._fleet_time.now_ns())
        self._ticks.publish(ClockMessage(clock=Time(nanoseconds=self._last_ns).to_msg()))
        self._tell_air()

    def _tell_air(self) -> None:
        """Publish the last report of the air, once."""
        link = self._link
        carried = None if link is None or link.opened is None else link.opened.air
        report = None if carried is None else carried.latest
        if report is None or report.stamp_ns == self._told_ns:
            return
        self._told_ns = report.stamp_ns
        for topic, message in encode_air(report).items():
            self._air[topic].publish(message)

    def statuses(self, now_ns: int) -> list[Status]:
        """Whether the vehicles are there, and by how much their time is ahead of the wall's."""
        facts = {"speedup": f"{self._options.speedup:g}"}
        facts["ahead_of_wall_s"] = f"{now_ns / 1e9 - time.time():.1f}"
        link = self._link
        if link is None or link.opened is None:
            note = "not active" if link is None else link.note
            return [Status("", WARN, f"no vehicles: {note}", facts)]
        count = len(link.opened.stations)
        return [Status("", OK, f"{count} vehicles", facts)]
