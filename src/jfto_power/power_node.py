"""Power allocation in the graph: from topology to a schedule and each UAV's setpoint."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Float64, Float64MultiArray, UInt8MultiArray
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.clock_watch import ClockWatch
from jfto_msgs_py.errors import InputError, JftoError, MessageError
from jfto_msgs_py.network import Adjacency, PowerIntervals, PowerSchedule, SlotHorizon
from jfto_msgs_py.records.event import Event
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.diagnostics import ERROR, OK, WARN, Status
from jfto_msgs_py.ros.energy import encode_energy_left
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.network import (
    decode_adjacency,
    decode_power_intervals,
    encode_power_schedule,
)
from jfto_msgs_py.ros.vehicle import decode_trajectory
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.units import w_to_dbm
from jfto_power.energy_account import EnergyAccount
from jfto_power.horizon import HorizonPower, plan_horizon
from jfto_power.power_events import PowerEvents
from jfto_power.power_options import PowerOptions
from jfto_world.motion.fleet_plan import FleetPlan
from jfto_world.motion.fleet_prediction import FleetPrediction
from jfto_world.radio import make_channel

# Slots without news of the topology before it counts as silent.
_SILENT_SLOTS = 2.0
_LISTEN_EVERY_S = 1.0


class PowerNode(GraphNode[PowerOptions]):
    """Publishes the best powers of each horizon, and each setpoint when its slot begins."""

    def __init__(self, **arguments: Any) -> None:
        self._found: HorizonPower | None = None
        self._heard_ns = 0
        self._trouble: dict[str, str] = {}
        self._clock_watch = ClockWatch()
        super().__init__("power_node", PowerOptions, **arguments)

    def check(self, scenario: Scenario, options: PowerOptions) -> None:
        """Refuse to serve a UAV that there is none of."""
        if options.uav_id and options.uav_id not in scenario.fleet.ids:
            raise InputError(
                f"uav_id is {options.uav_id!r}, must be one of {', '.join(scenario.fleet.ids)}."
            )

    def build(self, scenario: Scenario, options: PowerOptions) -> None:
        """Subscriptions, publishers, the energy account and the timer of slots."""
        ids = scenario.fleet.ids
        self._radio = scenario.radio.record()
        self._channel = make_channel(self._radio)
        self._slot_count, self._reserve = scenario.mission.slot_count, options.energy_reserve
        self._served = (options.uav_id,) if options.uav_id else ids
        budget_j = dict(zip(ids, scenario.fleet.energy_j, strict=True))
        self._account = EnergyAccount(
            budget_j, Path(options.state_file) if options.state_file else None, self.now_ns()
        )
        self._power_events = PowerEvents()
        self._plan = FleetPlan(ids)
        self._prediction = FleetPrediction()
        self._adjacency: Adjacency | None = None
        self._intervals: PowerIntervals | None = None
        for uav in ids:
            self.create_subscription(
                MultiDOFJointTrajectory,
                topics.trajectory(uav),
                partial(self._on_trajectory, uav),
                qos.latched(),
            )
            self.create_subscription(
                PoseStamped, topics.pose(uav), partial(self._on_pose, uav), qos.sensor()
            )
        self.create_subscription(
            UInt8MultiArray, topics.ADJACENCY, self._on_adjacency, qos.latched()
        )
        self.create_subscription(
            Float64MultiArray, topics.POWER_INTERVAL, self._on_intervals, qos.latched()
        )
        self._schedule = self.create_lifecycle_publisher(
            Float64MultiArray, topics.POWER_SCHEDULE, qos.latched()
        )
        self._setpoints = {
            uav: self.create_lifecycle_publisher(Float64, topics.tx_power(uav), qos.latched())
            for uav in self._served
        }
        self._energy_left = self.create_lifecycle_publisher(
            Float64MultiArray, topics.ENERGY_LEFT, qos.latched()
        )
        self.create_timer(_LISTEN_EVERY_S, self._listen)
        self._boundary = self.create_timer(3600.0, self._apply)
        self._boundary.cancel()

    def activated(self) -> None:
        """Solve what has come meanwhile."""
        self._solve()

    def released(self) -> None:
        """Forget the schedule; the account stays in its file."""
        self._found = None

    def _on_trajectory(self, uav: str, message: Any) -> None:
        trajectory = self.intake.take(topics.trajectory(uav), decode_trajectory, message)
        if trajectory is None or not self._plan.take(uav, trajectory):
            return
        self._prediction.set_trajectory(uav, trajectory)
        if self._plan.complete:
            now_ns = self.now_ns()
            if now_ns:
                self._account.advance(now_ns)
            self._account.set_zero(self._prediction.start_ns)
        self._solve()

    def _on_pose(self, uav: str, message: Any) -> None:
        if self._clock_watch.set_back_by_ns(self.now_ns()):
            self._prediction.forget_poses()
        pose = self.take_pose(uav, message)
        if pose is not None:
            self._prediction.set_pose(uav, pose)

    def _on_adjacency(self, message: Any) -> None:
        adjacency = self.intake.take(topics.ADJACENCY, decode_adjacency, message)
        if adjacency is not None and self._knows(topics.ADJACENCY, adjacency.uav_ids):
            self._adjacency = adjacency
            self._solve()

    def _on_intervals(self, message: Any) -> None:
        intervals = self.intake.take(topics.POWER_INTERVAL, decode_power_intervals, message)
        if intervals is not None and self._knows(topics.POWER_INTERVAL, intervals.uav_ids):
            self._intervals = intervals
            self._solve()

    def _knows(self, topic: str, uav_ids: tuple[str, ...]) -> bool:
        unknown = set(uav_ids) - set(self._plan.uav_ids)
        if unknown:
            names = ", ".join(sorted(unknown))
            self.intake.refuse(topic, MessageError("uav.ids", f"{names} not in the scenario"))
        return not unknown

    def _solve(self) -> None:
        """Solve once both messages of a horizon and all their trajectories are there."""
        adjacency, intervals = self._adjacency, self._intervals
        if not self.is_active or adjacency is None or intervals is None:
            return
        if (adjacency.horizon, adjacency.uav_ids) != (intervals.horizon, intervals.uav_ids):
            # The other half of the pair is on its way.
            return
        if not set(adjacency.uav_ids) <= set(self._prediction.uav_ids):
            return
        now_ns = self.now_ns()
        self._account.advance(now_ns)
        self._adjacency = self._intervals = None
        adjacency, intervals = _from_now_on(adjacency, intervals, now_ns)
        try:
            self._found = plan_horizon(
                adjacency,
                intervals,
                self._prediction.positions(adjacency.uav_ids, adjacency.horizon.instants_ns),
                self._account.left_j,
                slot_count=self._slot_count,
                channel=self._channel,
                radio=self._radio,
                reserve=self._reserve,
            )
        except JftoError as error:
            # What others ask for cannot be solved: the last schedule stays in force.
            self._trouble["allocation"] = str(error)
            self._tell(self._power_events.of_trouble(str(error)))
            return
        self._trouble.pop("allocation", None)
        self._heard_ns = now_ns
        mine = self._rows(self._found.schedule)
        if mine is not None:
            self._schedule.publish(encode_power_schedule(mine))
        self._apply()
        self._tell(
            [*self._power_events.of_trouble(""), *self._power_events.of_schedule(self._found)]
        )

    def _tell(self, events: Iterable[Event]) -> None:
        for event in events:
            # Of several power nodes each speaks for its own UAVs.
            if not event.uav_id or event.uav_id in self._served:
                self.announce(event)

    def _rows(self, schedule: PowerSchedule) -> PowerSchedule | None:
        """The rows of the UAVs that this node serves."""
        columns = [i for i, uav in enumerate(schedule.uav_ids) if uav in self._served]
        if not columns:
            return None
        ids = tuple(schedule.uav_ids[column] for column in columns)
        return PowerSchedule(schedule.horizon, ids, schedule.power_w[:, columns])

    def _row_at(self, now_ns: int) -> int:
        """Row of the schedule in force; the last one stays in force when it has run out."""
        assert self._found is not None
        horizon = self._found.schedule.horizon
        row = int((now_ns - horizon.t0_ns) // round(horizon.duration_s * 1e9))
        return min(max(row, 0), horizon.count - 1)

    def _apply(self) -> None:
        """Put the powers of the current slot in force, and wait for the next one.

        A UAV whose energy is used up is put to silence, in the middle of a slot if need be.
        """
        if self._found is None or not self.is_active:
            return
        now_ns = self.now_ns()
        self._account.advance(now_ns)
        schedule = self._found.schedule
        row = self._row_at(now_ns)
        powers = dict(self._account.power_w)
        powers |= dict(zip(schedule.uav_ids, schedule.power_w[row].tolist(), strict=True))
        used_up = [uav for uav in powers if self._account.used_up(uav)]
        powers |= dict.fromkeys(used_up, 0.0)
        changed = self._account.set_powers(now_ns, powers)
        for uav, publisher in self._setpoints.items():
            if uav in changed:
                publisher.publish(Float64(data=float(w_to_dbm(powers[uav]))))
        left_j = {uav: self._account.left_j[uav] for uav in self._served}
        self._energy_left.publish(encode_energy_left(now_ns, left_j))
        self._tell(self._power_events.of_energy(used_up))
        self._save(now_ns)
        self._wait(schedule.horizon, row, now_ns)

    def _wait(self, horizon: SlotHorizon, row: int, now_ns: int) -> None:
        """Until the next row's slot begins, or a UAV's energy is used up."""
        wake_ns = [] if row + 1 >= horizon.count else [int(horizon.instants_ns[row + 1])]
        empty_ns = self._account.empty_ns()
        wake_ns += [] if empty_ns is None else [empty_ns]
        if not wake_ns:
            self._boundary.cancel()
            return
        self._boundary.timer_period_ns = max(min(wake_ns) - now_ns, 1)
        self._boundary.reset()

    def _listen(self) -> None:
        """Notice that the topology has fallen silent."""
        if self._found is None or not self.is_active:
            return
        silent_s, run_out = self._silence(self.now_ns())
        self._tell(self._power_events.of_silence(silent_s, run_out=run_out))

    def _silence(self, now_ns: int) -> tuple[float, bool]:
        """For how long the topology has been silent, 0 where that is well, and past its horizon."""
        assert self._found is not None
        horizon = self._found.schedule.horizon
        silent_s = (now_ns - max(self._heard_ns, horizon.t0_ns)) / 1e9
        over = horizon.first + self._row_at(now_ns) >= self._slot_count
        if over or silent_s <= _SILENT_SLOTS * horizon.duration_s:
            return 0.0, False
        return silent_s, now_ns > horizon.t0_ns + round(horizon.count * horizon.duration_s * 1e9)

    def _save(self, now_ns: int) -> None:
        try:
            self._account.save(now_ns)
        except InputError as error:
            # Better to fly without a file than not to steer the radios.
            self._complain("state_file", str(error))
            return
        self._trouble.pop("state_file", None)

    def _complain(self, about: str, text: str) -> None:
        self._trouble[about] = text
        self.get_logger().error(text, throttle_duration_sec=5.0)

    def statuses(self, now_ns: int) -> list[Status]:
        """Energy left and power in force; whether the topology is silent."""
        self._account.advance(now_ns)
        return [self._about_all(now_ns), *(self._about(uav) for uav in self._served)]

    def _about_all(self, now_ns: int) -> Status:
        facts = self.intake.facts("/jfto/")
        facts |= self._trouble
        if self._found is None:
            return Status("", WARN, "waiting for a topology", facts)
        horizon = self._found.schedule.horizon
        slot = horizon.first + self._row_at(now_ns)
        facts["last_slot"] = str(slot)
        if self._found.shortage is not None:
            return Status("", ERROR, str(self._found.shortage), facts)
        silent_s, run_out = self._silence(now_ns)
        if silent_s:
            text = f"topology silent for {silent_s:.1f} s, going on through its last schedule"
            if run_out:
                text = f"topology silent for {silent_s:.1f} s, its last schedule has run out"
            return Status("", ERROR if run_out else WARN, text, facts)
        level = WARN if self._trouble else OK
        return Status("", level, " ".join([f"slot {slot}", *self._trouble.values()]), facts)

    def _about(self, uav: str) -> Status:
        facts = self.intake.facts(f"/{uav}/")
        left_j, budget_j = self._account.left_j[uav], self._account.budget_j[uav]
        power_w = self._account.power_w[uav]
        facts |= {"energy_left_j": f"{left_j:.3f}", "energy_budget_j": f"{budget_j:.3f}"}
        facts["tx_power_dbm"] = f"{w_to_dbm(power_w):.2f}"
        if left_j <= 0:
            return Status(uav, ERROR, "no energy left", facts)
        if self._found is not None and uav not in self._found.schedule.uav_ids:
            return Status(uav, WARN, "not part of the schedule, keeps its power", facts)
        return Status(uav, OK, f"{100 * left_j / budget_j:.0f} % of the energy left", facts)


def _from_now_on(
    adjacency: Adjacency, intervals: PowerIntervals, now_ns: int
) -> tuple[Adjacency, PowerIntervals]:
    """The slots that are not over yet: a late joiner hears of a horizon that began long ago."""
    horizon = adjacency.horizon
    gone = int((now_ns - horizon.t0_ns) // round(horizon.duration_s * 1e9))
    gone = min(max(gone, 0), horizon.count - 1)
    if not gone:
        return adjacency, intervals
    left = SlotHorizon(
        horizon.first + gone,
        int(horizon.instants_ns[gone]),
        horizon.duration_s,
        horizon.count - gone,
    )
    return (
        Adjacency(left, adjacency.uav_ids, adjacency.links[gone:]),
        PowerIntervals(left, intervals.uav_ids, intervals.bounds_w[gone:]),
    )
