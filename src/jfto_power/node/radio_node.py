"""Radios in the graph: setpoints are applied, and what was applied is told."""

from __future__ import annotations

import math
import shlex
from functools import partial
from pathlib import Path
from typing import Any

from std_msgs.msg import Float64

from jfto_msgs_py.errors import InputError, MessageError
from jfto_msgs_py.records.event import ERROR as ERROR_EVENT
from jfto_msgs_py.records.event import INFO, Event
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.diagnostics import ERROR, OK, WARN, Status
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.scenario import Scenario
from jfto_power.drivers import Applier, IwDriver, LogDriver, RadioDriver, RadioState, SimDriver
from jfto_power.drivers.applier import RETRY
from jfto_power.options import RadioOptions, served_ids

# How often what waits is looked at.
_LOOK_S = 0.25


class RadioNode(GraphNode[RadioOptions]):
    """Applies each UAV's power setpoint through a driver and publishes what was read back."""

    def __init__(self, **arguments: Any) -> None:
        self._troubled: set[str] = set()
        super().__init__("radio_node", RadioOptions, **arguments)

    def check(self, scenario: Scenario, options: RadioOptions) -> None:
        """Refuse a UAV that there is none of, and a driver without what it needs."""
        served_ids(options.uav_id, scenario.fleet.ids)
        if options.driver == "iw" and not options.uav_id:
            raise InputError("driver iw sets the radio of one UAV: say whose it is with uav_id.")
        if options.driver == "sim":
            _address(options.control)

    def build(self, scenario: Scenario, options: RadioOptions) -> None:
        """Driver, subscriptions, publishers and the timer."""
        self._served = served_ids(options.uav_id, scenario.fleet.ids)
        self._driver_name = options.driver
        numbers = {uav: number for number, uav in enumerate(scenario.fleet.ids, 1)}
        self._applier = Applier(
            self._make_driver(options, numbers),
            self._served,
            interval_s=options.interval_s if options.driver == "iw" else 0.0,
            tolerance_db=options.tolerance_db,
        )
        self._applied = {}
        for uav in self._served:
            self.create_subscription(
                Float64, topics.tx_power(uav), partial(self._on_setpoint, uav), qos.latched()
            )
            self._applied[uav] = self.create_lifecycle_publisher(
                Float64, topics.tx_power_applied(uav), qos.latched()
            )
        self.create_timer(_LOOK_S, self._step)

    def activated(self) -> None:
        """Apply what has come meanwhile."""
        self._step()

    def released(self) -> None:
        """Radios keep their last power; what ailed them is found anew."""
        self._troubled.clear()

    def _make_driver(self, options: RadioOptions, numbers: dict[str, int]) -> RadioDriver:
        if options.driver == "sim":
            served = {uav: numbers[uav] for uav in self._served}
            return SimDriver(served, _address(options.control))
        if options.driver == "iw":
            return IwDriver(
                options.uav_id,
                options.interface,
                command=shlex.split(options.iw_command),
                step_db=options.power_step_db,
                least_dbm=options.least_dbm,
            )
        return LogDriver(self._served, self._writer(options.log_file))

    def _writer(self, file: str) -> Any:
        if not file:
            return self.get_logger().info

        def write(line: str) -> None:
            try:
                with Path(file).open("a", encoding="utf-8") as out:
                    out.write(f"{self.now_ns() / 1e9:.3f} {line}\n")
            except OSError as error:
                raise InputError(f"log_file {file}: {error.strerror}. Choose another.") from error

        return write

    def _on_setpoint(self, uav: str, message: Any) -> None:
        dbm = float(message.data)
        if math.isnan(dbm) or dbm == math.inf:
            error = MessageError("data", f"is {dbm}, must be dBm or -inf")
            self.intake.refuse(topics.tx_power(uav), error)
            return
        self._applier.want(uav, dbm)
        self._step()

    def _step(self) -> None:
        if not self.is_active:
            return
        for state in self._applier.step(self.now_ns() / 1e9):
            if state.applied_dbm is not None:
                self._applied[state.uav_id].publish(Float64(data=state.applied_dbm))
            self._tell(state)

    def _tell(self, state: RadioState) -> None:
        """Say once that a radio does not do what it is told, and once that it does again."""
        uav = state.uav_id
        if state.trouble and uav not in self._troubled:
            self._troubled.add(uav)
            text = f"{state.trouble} Set again every {RETRY.first_s:g} s until it obeys."
            self.announce(Event(ERROR_EVENT, "radio", uav, " ".join(text.split())))
        elif not state.trouble and uav in self._troubled:
            self._troubled.discard(uav)
            text = f"The radio obeys again: {state.applied_dbm:.2f} dBm are in force."
            self.announce(Event(INFO, "radio", uav, text))

    def statuses(self, now_ns: int) -> list[Status]:
        """Each radio's setpoint and what it is set to."""
        del now_ns
        facts = {"driver": self._driver_name, **self.intake.facts("/jfto/")}
        states = [self._applier.state(uav) for uav in self._served]
        bad = [state.uav_id for state in states if state.trouble]
        if bad:
            node = Status("", ERROR, f"radios not as wanted: {', '.join(bad)}", facts)
        elif all(state.wanted_dbm is None for state in states):
            node = Status("", WARN, "waiting for setpoints", facts)
        else:
            node = Status("", OK, f"{len(states)} radios as wanted", facts)
        return [node, *(self._about(state) for state in states)]

    def _about(self, state: RadioState) -> Status:
        facts = self.intake.facts(f"/{state.uav_id}/")
        for name, value in (("wanted_dbm", state.wanted_dbm), ("applied_dbm", state.applied_dbm)):
            if value is not None:
                facts[name] = f"{value:.2f}"
        if state.trouble:
            return Status(state.uav_id, ERROR, state.trouble, facts)
        if state.applied_dbm is None:
            return Status(state.uav_id, WARN, "no setpoint yet", facts)
        return Status(state.uav_id, OK, f"{state.applied_dbm:.2f} dBm", facts)


def _address(text: str) -> tuple[str, int]:
    """Host and port of `host:port`; raises InputError."""
    host, _, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65536:
        raise InputError(f"control is {text!r}, must be host:port, such as 127.0.0.1:14500.")
    return host, int(port)
