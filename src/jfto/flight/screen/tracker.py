"""Follows a running flight by what it publishes, and makes the screen's state of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from jfto.flight.screen import phases
from jfto.flight.screen.state import UNHEARD, UNPLACED, FlightState, LinkState, UavState
from jfto_msgs_py.records.event import Event
from jfto_msgs_py.records.network import Adjacency
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import VehiclePose
from jfto_msgs_py.units import dbm_to_w, ratio_to_db
from jfto_planner.plan_trajectory import timed_trajectories
from jfto_power.energy_account import EnergyAccount
from jfto_topology.metrics import components
from jfto_world.motion.fleet_prediction import FleetPrediction
from jfto_world.radio import make_channel, pairwise_distances

# Enough for any screen; all events are in the bag.
_EVENTS_KEPT = 500
# A lag is not known to the last bit; so near to its waypoint a UAV is there.
_AT_S = 0.05


class FlightTracker:
    """Feed it records as messages come, and ask for `state` whenever the screen is drawn.

    Times are ns since the epoch on the vehicles' clock. Not safe across threads.
    """

    def __init__(self, plan: Plan, title: str) -> None:
        self._plan, self._title = plan, title
        self._ids = tuple(uav.id for uav in plan.uavs)
        self._channel = make_channel(plan.radio)
        self._sensitivity_w = float(dbm_to_w(plan.radio.sensitivity_dbm))
        self._prediction = FleetPrediction()
        self._energy = EnergyAccount({uav.id: uav.energy_j for uav in plan.uavs}, zero_ns=0)
        self._start_ns: int | None = None
        self._poses: dict[str, VehiclePose] = {}
        self._power_w: dict[str, float] = {}
        self._battery: dict[str, float] = {}
        self._landed: set[str] = set()
        self._linked: dict[str, bool] = {}
        self._reached: dict[str, tuple[int, float | None]] = {}
        # How late each was that has done its route.
        self._finished: dict[str, float] = {}
        self._adjacency: Adjacency | None = None
        self._events: list[Event] = []
        # On the way home nobody keeps to the plan's times, and that is no news.
        self.going_home = False

    def take_lift_off(self, start_ns: int) -> None:
        """The flight began; powers in force cost energy from here on."""
        if start_ns == self._start_ns:
            return
        self._start_ns = start_ns
        self._finished.clear()
        for uav, trajectory in timed_trajectories(self._plan, start_ns).items():
            self._prediction.set_trajectory(uav, trajectory)
        self._energy = EnergyAccount(self._energy.budget_j, zero_ns=0)
        self._energy.set_powers(start_ns, self._power_w)

    def take_pose(self, uav: str, pose: VehiclePose) -> None:
        """A measured pose; one older than the last is ignored."""
        if self._prediction.set_pose(uav, pose):
            self._poses[uav] = pose

    def take_linked(self, uav: str, *, linked: bool) -> None:
        """Whether the vehicle is heard, as the bridge has it."""
        self._linked[uav] = linked

    def take_reached(self, uav: str, count: int, late_s: float | None) -> None:
        """So many waypoints its autopilot has reported, the last of them so late.

        They count where the poses tell of fewer, as while it waits at a time gate.
        """
        self._reached[uav] = (count, late_s)

    def take_power(self, uav: str, dbm: float, now_ns: int) -> None:
        """The power that is in force from now on, -inf for silence."""
        self._power_w[uav] = float(dbm_to_w(dbm))
        if self._start_ns is not None:
            self._energy.set_powers(now_ns, {uav: self._power_w[uav]})

    def take_battery(self, uav: str, share: float) -> None:
        """Flight battery, 0 to 1 as in sensor_msgs/BatteryState; not a number where unknown."""
        if np.isfinite(share):
            self._battery[uav] = 100 * share

    def take_adjacency(self, adjacency: Adjacency) -> None:
        """Active links of the slots ahead."""
        self._adjacency = adjacency

    def take_event(self, event: Event) -> None:
        """What happened; one that comes twice, as from a node's memory, is taken once."""
        if event in self._events or (self.going_home and event.kind == "late"):
            return
        self._events = [*self._events, event][-_EVENTS_KEPT:]
        if event.kind == "landed":
            self._landed |= {event.uav_id} if event.uav_id else set(self._ids)

    def state(self, now_ns: int, doing: str = "") -> FlightState:
        """How everything stands; `doing` says what the fleet is at, found out where empty."""
        clock_s = None if self._start_ns is None else (now_ns - self._start_ns) / 1e9
        spare_db = self._spare_db()
        slot, active = self._current(now_ns)
        if self._start_ns is not None:
            self._energy.advance(now_ns)
        uavs = tuple(
            self._uav(index, now_ns, clock_s, spare_db, active) for index in range(len(self._ids))
        )
        if slot < 0 and clock_s is not None and clock_s >= 0:
            slot = min(int(clock_s / self._plan.slots.duration_s), self._plan.slots.count)
        return FlightState(
            title=self._title,
            doing=doing or phases.fleet_doing(clock_s, uavs),
            clock_s=clock_s,
            horizon_s=self._plan.slots.horizon_s,
            slot=slot,
            slot_count=self._plan.slots.count,
            k_min=self._plan.k_min,
            parts=self._parts(uavs, spare_db),
            uavs=uavs,
            events=tuple(self._events),
            lift_off_ns=self._start_ns,
        )

    def _uav(
        self,
        index: int,
        now_ns: int,
        clock_s: float | None,
        spare_db: NDArray[np.float64],
        active: NDArray[np.bool_] | None,
    ) -> UavState:
        uav, route = self._plan.uavs[index], self._plan.routes[index]
        pose = self._poses.get(uav.id)
        age_s = None if pose is None else max((now_ns - pose.stamp_ns) / 1e9, 0.0)
        arrivals = np.array(route.arrival_s)
        late_s = next_in_s = None
        done = 0
        if clock_s is not None and clock_s >= 0 and age_s is not None:
            late_s = self._prediction.lag_s(uav.id)
            # Nobody knows how far a silent one has come since.
            reached_s = clock_s - age_s - late_s + _AT_S
            done = int(np.searchsorted(arrivals, reached_s, side="right"))
            reached, told_s = self._reached.get(uav.id, (0, None))
            if reached > done or reached == len(arrivals):
                done = reached
                late_s = late_s if told_s is None else told_s
            if uav.id in self._finished or done == len(arrivals):
                # On the way home it is nowhere along its route.
                late_s = self._finished.setdefault(uav.id, late_s)
                if reached == len(arrivals) and told_s is not None:
                    late_s = self._finished[uav.id] = told_s
                done = len(arrivals)
            else:
                next_in_s = float(arrivals[done]) + late_s - clock_s
        phase = phases.phase_of(
            self._plan, index, pose, age_s, clock_s, done, landed=uav.id in self._landed
        )
        if phase == UNHEARD and self._linked.get(uav.id):
            phase = UNPLACED
        return UavState(
            id=uav.id,
            index=index,
            phase=phase,
            done=done,
            total=len(arrivals),
            next_in_s=next_in_s,
            late_s=late_s,
            energy_left_j=self._energy.left_j[uav.id],
            energy_budget_j=uav.energy_j,
            battery_percent=self._battery.get(uav.id),
            tx_dbm=self._tx_dbm(uav.id),
            links=self._links(index, spare_db, active),
            age_s=age_s,
        )

    def _tx_dbm(self, uav: str) -> float | None:
        power_w = self._power_w.get(uav)
        return None if power_w is None else float(ratio_to_db(power_w)) + 30.0

    def _spare_db(self) -> NDArray[np.float64]:
        """What each link could lose at the powers in force (A, A); nan where it is not known."""
        count = len(self._ids)
        places = np.full((count, 3), np.nan)
        power_w = np.full(count, np.nan)
        for index, uav in enumerate(self._ids):
            if uav in self._poses:
                places[index] = self._poses[uav].position_m
            power_w[index] = self._power_w.get(uav, np.nan)
        gain = self._channel.gain(pairwise_distances(places))
        received_w = np.minimum(power_w[:, None], power_w[None, :]) * gain
        return np.asarray(ratio_to_db(received_w / self._sensitivity_w))

    def _current(self, now_ns: int) -> tuple[int, NDArray[np.bool_] | None]:
        """The slot under way and its active links, as published; -1 and None where none is."""
        adjacency = self._adjacency
        if adjacency is None or adjacency.uav_ids != self._ids:
            return -1, None
        instants = adjacency.horizon.instants_ns
        row = int(np.searchsorted(instants, now_ns, side="right")) - 1
        row = min(max(row, 0), adjacency.horizon.count - 1)
        return adjacency.horizon.first + row, adjacency.links[row]

    def _links(
        self, index: int, spare_db: NDArray[np.float64], active: NDArray[np.bool_] | None
    ) -> tuple[LinkState, ...]:
        """Active links with what they can lose; before there is a topology, whoever hears whom."""
        found = []
        for other, name in enumerate(self._ids):
            spare = float(spare_db[index, other])
            wanted = spare >= 0 if active is None else bool(active[index, other])
            if other != index and wanted and not np.isnan(spare):
                found.append(LinkState(name, spare))
        return tuple(found)

    def _parts(self, uavs: Sequence[UavState], spare_db: NDArray[np.float64]) -> int:
        present = np.array([uav.phase in phases.IN_THE_AIR for uav in uavs])
        if not present.any():
            present = np.array([uav.phase in phases.LINKED for uav in uavs])
        present &= ~np.isnan(np.diagonal(spare_db))
        linked = spare_db >= 0
        np.fill_diagonal(linked, val=False)
        label = components(linked[None], present[None])
        return int(label.max(initial=-1)) + 1
