"""Power allocation in the graph: from topology to a schedule and each UAV's setpoint."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from std_msgs.msg import Float64, Float64MultiArray, UInt8MultiArray

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.air import encode_energy_left
from jfto_msgs_py.ros.core_node import CoreNode, fleet_inputs
from jfto_msgs_py.ros.diagnostics import Status
from jfto_msgs_py.ros.intake import Input
from jfto_msgs_py.ros.network import (
    decode_adjacency,
    decode_power_intervals,
    encode_power_schedule,
)
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.units import w_to_dbm
from jfto_power.core import PowerCore, PowerOutputs, energy_budgets, power_core
from jfto_power.energy_account import open_account, write_account
from jfto_power.node.statuses import about_fleet, about_uav
from jfto_power.options import PowerOptions, served_ids
from jfto_world.motion.fleet_tracking import AHEAD_S, AHEAD_SIMULATED_S


class PowerNode(CoreNode[PowerOptions, PowerOutputs]):
    """Publishes the best powers of each horizon, and each setpoint when its slot begins."""

    core: PowerCore

    def __init__(self, **arguments: Any) -> None:
        self._file_trouble = ""
        super().__init__("power_node", PowerOptions, **arguments)

    def check(self, scenario: Scenario, options: PowerOptions) -> None:
        """Refuse to serve a UAV that there is none of."""
        served_ids(options.uav_id, scenario.fleet.ids)

    def build(self, scenario: Scenario, options: PowerOptions) -> None:
        """The core with the energy account of its file, publishers and subscriptions."""
        self._file = Path(options.state_file) if options.state_file else None
        account = open_account(energy_budgets(scenario), self._file, self.now_ns())
        ahead_s = AHEAD_SIMULATED_S if self.time_is_simulated else AHEAD_S
        self.core = power_core(scenario, options, account, ahead_s)
        kinds = {topics.POWER_SCHEDULE: Float64MultiArray, topics.ENERGY_LEFT: Float64MultiArray}
        kinds |= {topics.tx_power(uav): Float64 for uav in self.core.served}
        self._publisher_of = {
            topic: self.create_lifecycle_publisher(kind, topic, qos.latched())
            for topic, kind in kinds.items()
        }
        self.connect(self.core, power_inputs(self.core, scenario.fleet.ids))

    def publish(self, made: PowerOutputs) -> None:
        """Schedule, setpoints and energy; then the account is saved and the operator told."""
        now_ns = self.now_ns()
        for topic, message in power_messages(made, now_ns):
            self._publisher_of[topic].publish(message)
        if self._file is not None and made.left_j:
            self._save(self._file, now_ns)
        for event in made.events:
            self.announce(event)

    def _save(self, file: Path, now_ns: int) -> None:
        try:
            write_account(self.core.account.state(now_ns), file)
        except InputError as error:
            # Better to fly without a file than not to steer the radios.
            self._file_trouble = str(error)
            self.get_logger().error(self._file_trouble, throttle_duration_sec=5.0)
            return
        self._file_trouble = ""

    def statuses(self, now_ns: int) -> list[Status]:
        """Energy left and power in force; whether the topology is silent."""
        core, facts = self.core, self.intake.facts
        core.account.advance(now_ns)
        troubles = {"allocation": core.trouble, "state_file": self._file_trouble}
        return [
            about_fleet(core, troubles, facts("/jfto/"), now_ns),
            *(about_uav(core, uav, facts(f"/{uav}/")) for uav in core.served),
        ]


def power_inputs(core: PowerCore, fleet_ids: tuple[str, ...]) -> list[Input]:
    """What the core is fed with: trajectories and poses of the fleet, and its topology."""
    links, powers, latched = topics.ADJACENCY, topics.POWER_INTERVAL, qos.latched()
    return [
        *fleet_inputs(core, fleet_ids),
        Input(UInt8MultiArray, links, latched, decode_adjacency, core.take_adjacency),
        Input(Float64MultiArray, powers, latched, decode_power_intervals, core.take_intervals),
    ]


def power_messages(made: PowerOutputs, now_ns: int) -> Iterator[tuple[str, Any]]:
    """Topics and messages of a step's outputs."""
    if made.schedule is not None:
        yield topics.POWER_SCHEDULE, encode_power_schedule(made.schedule)
    for uav, power_w in made.setpoints_w.items():
        yield topics.tx_power(uav), Float64(data=float(w_to_dbm(power_w)))
    if made.left_j:
        yield topics.ENERGY_LEFT, encode_energy_left(now_ns, made.left_j)
