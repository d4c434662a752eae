"""C-TOP in flight, without ROS: records of plans, poses and radios in, the topology out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from jfto_msgs_py.errors import InputError, MessageError
from jfto_msgs_py.records.air import AirArray
from jfto_msgs_py.records.event import WARN, Event
from jfto_msgs_py.records.vehicle import TimedTrajectory, VehiclePose
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.units import dbm_to_w, ratio_to_db
from jfto_topology.fleet_events import FleetEvents
from jfto_topology.flight_watch import FlightWatch
from jfto_topology.horizon import HorizonSettings, HorizonTopology, TopologyHorizon
from jfto_topology.links import SPREADS, Links
from jfto_topology.options import TopologyOptions
from jfto_world.motion.fleet_tracking import AHEAD_S, FleetTracking
from jfto_world.radio import LossEstimate, make_channel, noise_w, pairwise_distances

# How soon to look again for a fleet that nobody hears of, at least.
_RETRY_S = 0.1


@dataclass(frozen=True)
class TopologySettings:
    """What does not change in flight.

    `links` are the fleet's radio rules; `slot_count` slots last `horizon_s` together, as long as
    the plan where that is 0. UAVs are to stay `d_min_m` apart. A pose that is stamped more than
    `ahead_s` ahead of the clock is refused.
    """

    links: Links
    slot_count: int
    horizon_s: float
    d_min_m: float
    options: TopologyOptions = field(default_factory=TopologyOptions)
    ahead_s: float = AHEAD_S


@dataclass(frozen=True, eq=False)
class TopologyOutputs:
    """What one step makes.

    `solved` is there where a slot's topology was solved. `wake_ns` is when the next step is due
    though no record comes, None while the fleet has no plan.
    """

    solved: HorizonTopology | None
    wake_ns: int | None


@dataclass(frozen=True, eq=False)
class Scene:
    """A fleet at `stamp_ns`, to be drawn: positions (A, 3) of the UAVs of `paths_m`, and links.

    `paths_m` has each UAV's planned path (M, 3), ENU metres like all positions; it is the same
    object as long as the plan is. `links` (L, L) and `margins_db` (L, L) are over `linked_ids`, the
    UAVs that take part.
    """

    stamp_ns: int
    paths_m: Mapping[str, Array]
    positions_m: Array
    linked_ids: tuple[str, ...]
    links: Flags
    margins_db: Array


class TopologyCore:
    """Solves the slots ahead as soon as a slot's poses have come, or were waited for.

    Take records over as they come, and step whenever `due` says so and at `wake_ns`; stepping more
    often changes nothing. What is not urgent is made afterwards: `review` and `scene`. Times are ns
    since the epoch, on one clock.
    """

    def __init__(self, settings: TopologySettings) -> None:
        self.settings = settings
        self.uav_ids = tuple(settings.links.p_max_w)
        self.solved: HorizonTopology | None = None
        self._tracking = FleetTracking(self.uav_ids, settings.ahead_s)
        self.prediction = self._tracking.prediction
        self._links = settings.links
        self._losses = LossEstimate(self._links.channel)
        self._left_j: dict[str, float] = {}
        self._horizon: TopologyHorizon | None = None
        self._paths_m: dict[str, Array] = {}
        self._fleet_events = FleetEvents(self.prediction)
        self._watch = FlightWatch(
            self.prediction, self._links, settings.d_min_m, settings.options.watch_slots
        )
        self._events: list[Event] = []
        # Whether somebody waits for a first `wake_ns`, and for the events of what was solved last.
        self._new_plan = self._unreviewed = False
        self._since_ns: int | None = None

    def take_trajectory(self, uav_id: str, trajectory: TimedTrajectory, _now_ns: int) -> None:
        """A UAV's plan; plans of one planning begin together, until then the fleet has none.

        Raises MessageError where the plans make no slots.
        """
        if not self._tracking.take_trajectory(uav_id, trajectory):
            return
        self._horizon = None
        if not self._tracking.complete:
            return
        try:
            self._horizon = self._make_horizon()
        except InputError as error:
            raise MessageError("points", str(error)) from error
        trajectories = self._tracking.trajectories
        self._paths_m = {uav: trajectories[uav].position_m for uav in self.uav_ids}
        self._new_plan = True

    def take_pose(self, uav_id: str, pose: VehiclePose, now_ns: int) -> None:
        """A measured pose. Raises MessageError for one from the future."""
        self._follow_clock(now_ns)
        self._tracking.take_pose(uav_id, pose, now_ns)

    def take_energy(self, left_j: Mapping[str, float], _now_ns: int) -> None:
        """Energy left to radios, J."""
        self._left_j.update(left_j)

    def take_gain(self, gain: AirArray, _now_ns: int) -> None:
        """Gains (A, A) that radios measured, 0 where nothing was received.

        They are compared with the channel, where the UAVs are believed to have been.
        """
        if not set(gain.uav_ids) <= set(self.prediction.uav_ids):
            return
        at = self.prediction.positions(gain.uav_ids, np.array([gain.stamp_ns]))[0]
        self._losses.take(gain.stamp_ns, gain.values, at)
        margin_db = self.settings.options.margin_db + SPREADS * self._losses.spread_db
        self._links = replace(self._links, loss_db=self._losses.loss_db, margin_db=margin_db)
        if self._horizon is not None:
            self._horizon.links = self._links

    def listen(self) -> None:
        """Begin to wait for poses: whoever listens from now on may have missed some."""
        self._since_ns = None

    def due(self, now_ns: int) -> bool:
        """Whether a step has something to do."""
        if self._events or self._horizon is None:
            return bool(self._events)
        return self._new_plan or self._horizon.due(now_ns)

    def step(self, now_ns: int) -> TopologyOutputs:
        """Solve the slot that is due, if one is."""
        self._follow_clock(now_ns)
        horizon = self._horizon
        if horizon is None:
            return TopologyOutputs(None, None)
        self._new_plan = False
        if self._since_ns is None:
            self._since_ns = now_ns
        solved = None
        if horizon.due(now_ns) and self._may_solve(horizon, now_ns):
            solved = horizon.solve(now_ns)
        if solved is not None:
            self.solved, self._unreviewed = solved, True
        return TopologyOutputs(solved, self._wake_ns(horizon, now_ns))

    def review(self, now_ns: int) -> list[Event]:
        """What the operator is to be told since the last review."""
        events, self._events = self._events, []
        if self.solved is not None and self._unreviewed:
            self._unreviewed = False
            events += self._fleet_events.of_slot(self.solved, now_ns)
            events += self._watch.look(self.solved, self.settings.slot_count, now_ns, self._left_j)
        return events

    def scene(self, solved: HorizonTopology, now_ns: int) -> Scene:
        """The fleet now, with the links of what was solved."""
        return Scene(
            now_ns,
            self._paths_m,
            self.prediction.positions(self.uav_ids, np.array([now_ns]))[0],
            solved.adjacency.uav_ids,
            solved.adjacency.links[0],
            self.margins_db(solved),
        )

    def margins_db(self, solved: HorizonTopology) -> Array:
        """What each pair could lose in the current slot, weaker end at greatest power, in dB."""
        uav_ids, horizon = solved.adjacency.uav_ids, solved.adjacency.horizon
        positions = self.prediction.positions(uav_ids, horizon.instants_ns[:1])
        gain = self._links.channel.gain(pairwise_distances(positions))[0]
        power_w = np.array([self._links.p_max_w[uav] for uav in uav_ids])
        weaker_w = np.minimum(power_w[:, None], power_w[None, :])
        return np.asarray(ratio_to_db(weaker_w * gain / self._links.sensitivity_w))

    @property
    def missing(self) -> tuple[str, ...]:
        """UAVs whose trajectories are waited for."""
        return self._tracking.missing if self._horizon is None else ()

    @property
    def dangers(self) -> Mapping[tuple[str, str], str]:
        """What is predicted to go wrong: texts by kind and UAVs."""
        return self._watch.dangers

    def _make_horizon(self) -> TopologyHorizon:
        """Slots of the mission over the plan; raises InputError where that makes none."""
        settings, options = self.settings, self.settings.options
        duration_s = settings.horizon_s or self._tracking.duration_s
        slot_s = duration_s / settings.slot_count
        timing = HorizonSettings(
            settings.slot_count,
            slot_s,
            options.horizon_slots,
            options.stale_after_s,
            # A short slot leaves less time to wait.
            min(options.pose_wait_s, 0.5 * slot_s),
        )
        horizon = TopologyHorizon(self.prediction, self._links, timing)
        horizon.left_j = self._left_j
        return horizon

    def _follow_clock(self, now_ns: int) -> None:
        """Forget poses that a clock has stamped which was since set back."""
        back_ns = self._tracking.follow_clock(now_ns)
        if back_ns:
            self._since_ns = None
            text = f"The clock was set back by {back_ns / 1e9:.1f} s: earlier poses do not count."
            self._events.append(Event(WARN, "topology", "", text))

    def _may_solve(self, horizon: TopologyHorizon, now_ns: int) -> bool:
        """Whether UAVs without a fresh pose have had the time to send one since we listen."""
        assert self._since_ns is not None
        fresh = self.prediction.fresh(now_ns, horizon.settings.stale_after_s)
        waited_ns = now_ns - self._since_ns
        return len(fresh) == len(self.uav_ids) or waited_ns >= horizon.settings.pose_wait_s * 1e9

    def _wake_ns(self, horizon: TopologyHorizon, now_ns: int) -> int:
        """When the next slot is solved whether or not its poses have come."""
        assert self._since_ns is not None
        wait_s = horizon.settings.pose_wait_s
        # At the end of the first wait nothing may have come that could be waited for.
        first_ns = self._since_ns + round(wait_s * 1e9)
        wake_ns = max(horizon.deadline_ns(now_ns), first_ns)
        if wake_ns > now_ns:
            return wake_ns
        # Overdue, with hardly anybody to reckon with.
        return now_ns + round(max(wait_s, _RETRY_S) * 1e9)


def topology_core(
    scenario: Scenario, options: TopologyOptions, ahead_s: float = AHEAD_S
) -> TopologyCore:
    """The core of a scenario's fleet."""
    radio, network, mission = scenario.radio, scenario.network, scenario.mission
    p_max_w = dbm_to_w(np.array(scenario.fleet.p_max_dbm))
    links = Links(
        make_channel(radio),
        dict(zip(scenario.fleet.ids, p_max_w.tolist(), strict=True)),
        float(dbm_to_w(radio.sensitivity_dbm)),
        network.k_min,
        network.delta,
        options.margin_db,
        form=network.topology,
        noise_w=noise_w(radio),
    )
    return TopologyCore(
        TopologySettings(
            links, mission.slot_count, mission.horizon_s, mission.d_min_m, options, ahead_s
        )
    )
