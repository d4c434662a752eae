"""Flights as a simple fleet would fly them, and bags that they leave."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jfto.analysis.record import SETPOINT, PowerSteps, RecordedFlight, Track
from jfto.bag.recorder import BagRecorder
from jfto_msgs_py.records.air import AirReport
from jfto_msgs_py.records.event import Event
from jfto_msgs_py.records.network import Adjacency, SlotHorizon
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import VehiclePose
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.air import encode_air
from jfto_msgs_py.ros.events import encode_event
from jfto_msgs_py.ros.lift_off import encode_lift_off
from jfto_msgs_py.ros.network import encode_adjacency
from jfto_msgs_py.ros.vehicle import encode_pose
from jfto_msgs_py.units import w_to_dbm
from jfto_planner.plan_trajectory import timed_trajectories
from jfto_world.motion.progress import sample
from support.fleets import START_NS

STEP_S = 0.25
# After the last waypoint all are back on their pads within this time.
HOME_S = 20.0


@dataclass(frozen=True)
class Flaws:
    """What goes wrong with UAVs, by id: how late they fly, by how far they are off (ENU, m),
    when they fall silent for good, and from when to when nothing is heard of them.
    """

    late_s: Mapping[str, float] = field(default_factory=dict)
    off_m: Mapping[str, Sequence[float]] = field(default_factory=dict)
    gone_s: Mapping[str, float] = field(default_factory=dict)
    unheard_s: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def tracks_of(plan: Plan, flaws: Flaws | None = None) -> dict[str, Track]:
    """Where each UAV was measured, from a little before lift-off until it is back on its pad."""
    flaws = flaws or Flaws()
    end_s = plan.slots.horizon_s + max(flaws.late_s.values(), default=0.0)
    times = np.arange(-2.0, end_s + HOME_S + 2.0, STEP_S)
    found = {}
    for uav, motion in zip(plan.uavs, timed_trajectories(plan, START_NS).values(), strict=True):
        late = flaws.late_s.get(uav.id, 0.0)
        places = sample(motion.offset_ns / 1e9, motion.position_m, times - late)
        share = np.clip((times - end_s) / HOME_S, 0.0, 1.0)[:, None]
        places = places * (1 - share) + np.array(uav.start_m) * share
        places = places + np.array(flaws.off_m.get(uav.id, (0.0, 0.0, 0.0)))
        low, high = flaws.unheard_s.get(uav.id, (np.inf, -np.inf))
        kept = (times <= flaws.gone_s.get(uav.id, np.inf)) & ~((times > low) & (times < high))
        found[uav.id] = Track(times[kept], places[kept])
    return found


def recorded(
    plan: Plan,
    power_w: NDArray[np.float64],
    flaws: Flaws | None = None,
    events: Sequence[Event] = (),
) -> RecordedFlight:
    """The flight with powers (N + 1, A) put in force at the plan's slots."""
    ids = tuple(uav.id for uav in plan.uavs)
    return RecordedFlight(
        uav_ids=ids,
        lift_off_ns=START_NS,
        lift_off_source="a test",
        tracks=tracks_of(plan, flaws),
        powers={
            uav: PowerSteps(plan.slots.times_s, power_w[:, index], SETPOINT)
            for index, uav in enumerate(ids)
        },
        events=tuple(events),
    )


class FlightBag:
    """Writes a flight as the graph's recorder does; it is received `pace` times faster."""

    def __init__(self, path: Path, *, pace: float = 1.0) -> None:
        self._recorder = BagRecorder(path)
        self._pace = pace
        self._waiting: list[tuple[int, str, str, object]] = []

    def put(self, topic: str, type_name: str, at_s: float, message: object) -> None:
        """A message sent at `at_s` seconds after lift-off."""
        received_ns = START_NS + 10**15 + round(at_s / self._pace * 1e9)
        self._waiting.append((received_ns, topic, type_name, message))

    def poses(self, tracks: Mapping[str, Track]) -> None:
        """Poses of tracks."""
        for uav, track in tracks.items():
            for at_s, place in zip(track.times_s, track.position_m.tolist(), strict=True):
                pose = VehiclePose(START_NS + round(at_s * 1e9), tuple(place), 0.0)
                kind = "geometry_msgs/msg/PoseStamped"
                self.put(topics.pose(uav), kind, at_s, encode_pose(pose))

    def lift_off(self) -> None:
        """The bridge's word that the flight began."""
        kind = "std_msgs/msg/Header"
        self.put(topics.LIFT_OFF, kind, 0.0, encode_lift_off(START_NS, "0" * 16))

    def powers(self, plan: Plan, power_w: NDArray[np.float64], *, applied: bool = False) -> None:
        """Setpoints (N + 1, A) at the plan's slots, or what radios say that they are set to."""
        from std_msgs.msg import Float64

        for index, uav in enumerate(plan.uavs):
            name = topics.tx_power_applied(uav.id) if applied else topics.tx_power(uav.id)
            for at_s, watt in zip(plan.slots.times_s, power_w[:, index], strict=True):
                self.put(name, "std_msgs/msg/Float64", at_s, Float64(data=float(w_to_dbm(watt))))

    def adjacency(self, plan: Plan, first: int, at_s: float, links: NDArray[np.bool_]) -> None:
        """The topology of one slot that begins at `at_s`."""
        horizon = SlotHorizon(first, START_NS + round(at_s * 1e9), plan.slots.duration_s, 1)
        message = encode_adjacency(Adjacency(horizon, tuple(u.id for u in plan.uavs), links[None]))
        self.put(topics.ADJACENCY, "std_msgs/msg/UInt8MultiArray", at_s, message)

    def event(self, event: Event) -> None:
        """What happened."""
        at_s = (event.stamp_ns - START_NS) / 1e9
        self.put(topics.EVENTS, "rcl_interfaces/msg/Log", at_s, encode_event(event))

    def air(self, report: AirReport) -> None:
        """What the air reports at a moment."""
        at_s = (report.stamp_ns - START_NS) / 1e9
        for topic, message in encode_air(report).items():
            self.put(topic, "std_msgs/msg/Float64MultiArray", at_s, message)

    def close(self) -> None:
        """Write all in the order of reception."""
        from rclpy.serialization import serialize_message

        known = set()
        for received_ns, topic, type_name, message in sorted(self._waiting, key=lambda one: one[0]):
            if topic not in known:
                known.add(topic)
                self._recorder.add_topic(topic, type_name, [])
            self._recorder.write(topic, received_ns, serialize_message(message))
        self._recorder.close()
