"""Powers in flight, without ROS: records of poses and topology in, schedule and setpoints out."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.errors import JftoError, MessageError
from jfto_msgs_py.records.event import Event
from jfto_msgs_py.records.network import Adjacency, PowerIntervals, PowerSchedule
from jfto_msgs_py.records.vehicle import TimedTrajectory, VehiclePose
from jfto_msgs_py.scenario import Scenario
from jfto_power.energy_account import EnergyAccount
from jfto_power.horizon import HorizonPower, HorizonRules, from_now_on, plan_horizon
from jfto_power.options import PowerOptions, served_ids
from jfto_power.power_events import PowerEvents
from jfto_world.motion.fleet_tracking import AHEAD_S, FleetTracking
from jfto_world.radio import make_channel

# Slots without a topology before it counts as silent.
_SILENT_SLOTS = 2.0


@dataclass(frozen=True, eq=False)
class PowerOutputs:
    """What one step makes, of the UAVs served.

    `schedule` is there where a horizon was solved; `setpoints_w` has the powers in force from now
    on that were not before, `left_j` the energy left, empty before the first schedule. `wake_ns` is
    when the next step is due though no record comes, None where it never is.
    """

    schedule: PowerSchedule | None
    setpoints_w: dict[str, float]
    left_j: dict[str, float]
    events: tuple[Event, ...]
    wake_ns: int | None


class PowerCore:
    """Solves each horizon as soon as both its halves are there, and puts its rows in force.

    Take records over as they come, and step whenever `due` says so and at `wake_ns`; stepping more
    often changes nothing. It serves `served` of the fleet whose `account` it keeps, all where None.
    Times are ns since the epoch, on one clock.
    """

    def __init__(
        self,
        rules: HorizonRules,
        account: EnergyAccount,
        served: tuple[str, ...] | None = None,
        ahead_s: float = AHEAD_S,
    ) -> None:
        self.account = account
        self.served = tuple(account.budget_j) if served is None else served
        self.solved: HorizonPower | None = None
        self.trouble = ""
        self._rules = rules
        self._tracking = FleetTracking(tuple(account.budget_j), ahead_s)
        self._events = PowerEvents()
        self._adjacency: Adjacency | None = None
        self._intervals: PowerIntervals | None = None
        self._solved_ns = 0

    def take_trajectory(self, uav_id: str, trajectory: TimedTrajectory, now_ns: int) -> None:
        """A UAV's plan; energy is charged from the beginning of a whole fleet's."""
        if not self._tracking.take_trajectory(uav_id, trajectory) or not self._tracking.complete:
            return
        if now_ns:
            self.account.advance(now_ns)
        self.account.set_zero(self._tracking.prediction.start_ns)

    def take_pose(self, uav_id: str, pose: VehiclePose, now_ns: int) -> None:
        """A measured pose. Raises MessageError for one from the future."""
        self._tracking.follow_clock(now_ns)
        self._tracking.take_pose(uav_id, pose, now_ns)

    def take_adjacency(self, adjacency: Adjacency, _now_ns: int) -> None:
        """Links of a horizon. Raises MessageError where they name UAVs that there are none of."""
        self._check_ids(adjacency.uav_ids)
        self._adjacency = adjacency

    def take_intervals(self, intervals: PowerIntervals, _now_ns: int) -> None:
        """Power intervals of a horizon. Raises MessageError as `take_adjacency` does."""
        self._check_ids(intervals.uav_ids)
        self._intervals = intervals

    def due(self, _now_ns: int) -> bool:
        """Whether both halves of a horizon are there, and all their trajectories."""
        adjacency, intervals = self._adjacency, self._intervals
        return (
            adjacency is not None
            and intervals is not None
            and adjacency.horizon == intervals.horizon
            and adjacency.uav_ids == intervals.uav_ids
            and set(adjacency.uav_ids) <= set(self._tracking.prediction.uav_ids)
        )

    def step(self, now_ns: int) -> PowerOutputs:
        """Solve what is due, and put the powers of the current slot in force.

        A UAV whose energy is used up is put to silence, in the middle of a slot if need be.
        """
        self.account.advance(now_ns)
        schedule: PowerSchedule | None = None
        events: list[Event] = []
        if self.due(now_ns):
            schedule, events = self._solve(now_ns)
        if self.solved is None:
            return PowerOutputs(None, {}, {}, self._own(events), None)
        planned = self.solved.schedule
        row = self._row_at(now_ns)
        powers = dict(self.account.power_w)
        powers |= dict(zip(planned.uav_ids, planned.power_w[row].tolist(), strict=True))
        used_up = [uav for uav in powers if self.account.used_up(uav)]
        powers |= dict.fromkeys(used_up, 0.0)
        changed = self.account.set_powers(now_ns, powers)
        silent_s, run_out = self.silence(now_ns)
        events += self._events.of_energy(used_up)
        events += self._events.of_silence(silent_s, run_out=run_out)
        return PowerOutputs(
            schedule,
            {uav: powers[uav] for uav in self.served if uav in changed},
            {uav: self.account.left_j[uav] for uav in self.served},
            self._own(events),
            self._wake_ns(row, now_ns),
        )

    def slot_at(self, now_ns: int) -> int:
        """The slot whose powers are in force, once there is a schedule."""
        assert self.solved is not None
        return self.solved.schedule.horizon.first + self._row_at(now_ns)

    def silence(self, now_ns: int) -> tuple[float, bool]:
        """For how long no topology has come, s, 0 where that is well, and past its horizon."""
        if self.solved is None or self.slot_at(now_ns) >= self._rules.slot_count:
            return 0.0, False
        silent_ns, run_out_ns = self._limits_ns()
        if now_ns <= silent_ns:
            return 0.0, False
        return (now_ns - self._since_ns()) / 1e9, now_ns > run_out_ns

    def _check_ids(self, uav_ids: tuple[str, ...]) -> None:
        unknown = set(uav_ids) - set(self._tracking.uav_ids)
        if unknown:
            raise MessageError("uav.ids", f"{', '.join(sorted(unknown))} not in the scenario")

    def _solve(self, now_ns: int) -> tuple[PowerSchedule | None, list[Event]]:
        """Powers of the horizon that has come; where that fails the last schedule stays."""
        assert self._adjacency is not None
        assert self._intervals is not None
        adjacency, intervals = from_now_on(self._adjacency, self._intervals, now_ns)
        self._adjacency = self._intervals = None
        positions_m = self._tracking.prediction.positions(
            adjacency.uav_ids, adjacency.horizon.instants_ns
        )
        try:
            solved = plan_horizon(
                adjacency, intervals, positions_m, self.account.left_j, self._rules
            )
        except JftoError as error:
            self.trouble = str(error)
            return None, self._events.of_trouble(self.trouble)
        self.trouble = ""
        self.solved, self._solved_ns = solved, now_ns
        return self._rows(solved.schedule), [
            *self._events.of_trouble(""),
            *self._events.of_schedule(solved),
        ]

    def _own(self, events: list[Event]) -> tuple[Event, ...]:
        """Of several cores each speaks for its own UAVs."""
        return tuple(event for event in events if not event.uav_id or event.uav_id in self.served)

    def _rows(self, schedule: PowerSchedule) -> PowerSchedule | None:
        """The schedule of the UAVs served."""
        columns = [i for i, uav in enumerate(schedule.uav_ids) if uav in self.served]
        if not columns:
            return None
        ids = tuple(schedule.uav_ids[column] for column in columns)
        return PowerSchedule(schedule.horizon, ids, schedule.power_w[:, columns])

    def _row_at(self, now_ns: int) -> int:
        """Row of the schedule in force; the last one stays in force when it has run out."""
        assert self.solved is not None
        horizon = self.solved.schedule.horizon
        row = int((now_ns - horizon.t0_ns) // round(horizon.duration_s * 1e9))
        return min(max(row, 0), horizon.count - 1)

    def _since_ns(self) -> int:
        """Since when a newer topology is waited for."""
        assert self.solved is not None
        return max(self._solved_ns, self.solved.schedule.horizon.t0_ns)

    def _limits_ns(self) -> tuple[int, int]:
        """When the topology becomes silent, and when the schedule runs out."""
        assert self.solved is not None
        horizon = self.solved.schedule.horizon
        silent_ns = self._since_ns() + round(_SILENT_SLOTS * horizon.duration_s * 1e9)
        return silent_ns, horizon.t0_ns + round(horizon.count * horizon.duration_s * 1e9)

    def _wake_ns(self, row: int, now_ns: int) -> int | None:
        """When the next row's slot begins, energy is used up, or silence is to be noticed."""
        assert self.solved is not None
        horizon = self.solved.schedule.horizon
        wakes = [limit_ns + 1 for limit_ns in self._limits_ns()]
        if row + 1 < horizon.count:
            wakes.append(int(horizon.instants_ns[row + 1]))
        empty_ns = self.account.empty_ns()
        if empty_ns is not None:
            wakes.append(max(empty_ns, now_ns + 1))
        return min((wake_ns for wake_ns in wakes if wake_ns > now_ns), default=None)


def power_core(
    scenario: Scenario,
    options: PowerOptions,
    account: EnergyAccount | None = None,
    ahead_s: float = AHEAD_S,
) -> PowerCore:
    """The core of a scenario's fleet; with full budgets where no account is given.

    Raises InputError where `uav_id` is none of the fleet.
    """
    if account is None:
        account = EnergyAccount(energy_budgets(scenario))
    radio = scenario.radio
    rules = HorizonRules(
        scenario.mission.slot_count, make_channel(radio), radio, options.energy_reserve
    )
    return PowerCore(rules, account, served_ids(options.uav_id, scenario.fleet.ids), ahead_s)


def energy_budgets(scenario: Scenario) -> dict[str, float]:
    """Energy of each UAV's radio, J."""
    return dict(zip(scenario.fleet.ids, scenario.fleet.energy_j, strict=True))
