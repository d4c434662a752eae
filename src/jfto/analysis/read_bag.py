"""Reads a flight back from its bag, whatever of it is there."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from jfto.analysis.clock import TimeMap, seen_lift_off_ns
from jfto.analysis.record import (
    READ_BACK,
    SETPOINT,
    UNKNOWN,
    AirLog,
    PowerSteps,
    RecordedFlight,
    Track,
    Trouble,
)
from jfto.bag.contents import BagError, BagMessage
from jfto.bag.reader import Bag
from jfto_msgs_py.errors import InputError, MessageError
from jfto_msgs_py.plan_file import plan_tag
from jfto_msgs_py.records.event import Event
from jfto_msgs_py.records.network import Adjacency, PowerSchedule
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.air import decode_air_array
from jfto_msgs_py.ros.diagnostics import OK, Diagnostics, Status, decode_diagnostics
from jfto_msgs_py.ros.events import decode_event
from jfto_msgs_py.ros.lift_off import decode_lift_off
from jfto_msgs_py.ros.network import decode_adjacency, decode_power_schedule
from jfto_msgs_py.ros.stamps import decode_time
from jfto_msgs_py.ros.vehicle import decode_pose
from jfto_msgs_py.units import dbm_to_w

# Rank of each of the air's arrays.
_AIR = {
    topics.AIR_POWER: ("power", 1),
    topics.AIR_ENERGY: ("energy", 1),
    topics.AIR_RATE: ("rate", 2),
    topics.AIR_DELIVERY: ("delivery", 2),
}
# A start that was foreseen is not believed where the vehicles climbed at another time.
_APART_NS = 2 * 10**9
# Diagnostics come once a second; a longer silence ends a spell.
_SPELL_GAP_S = 3.0
_INDEX = re.compile(r"\[\d+\]")


def read_flight(paths: Sequence[Path], plan: Plan) -> RecordedFlight:
    """The flight of a plan in its bags: several where the recorder was started again.

    Bags without poses, powers or anything else are read for what they have, and the notes say what
    is missing. Raises BagError where none of them is a bag, InputError where nothing tells when
    the flight began.
    """
    reading = _Reading(plan)
    broken: list[BagError] = []
    complete = len(paths) == 1
    for path in paths:
        try:
            bag = Bag(path)
            for message in bag.messages(reading.takers.keys()):
                reading.take(message)
        except BagError as error:
            broken.append(error)
            continue
        complete &= bag.facts.complete
    if broken and len(broken) == len(paths):
        raise broken[0]
    return reading.flight(paths[0], broken, complete=complete)


class _Reading:
    """Messages of a bag by what they are for."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.uav_ids = tuple(uav.id for uav in plan.uavs)
        self._types = get_typestore(Stores.ROS2_JAZZY)
        self._malformed: Counter[str] = Counter()
        self._poses: dict[str, list[tuple[int, tuple[float, float, float]]]] = defaultdict(list)
        self._clock: list[tuple[int, int]] = []
        self._power: dict[tuple[str, str], list[tuple[int, float]]] = defaultdict(list)
        self._starts: list[int] = []
        self._lift_offs: list[tuple[int, str]] = []
        self._air: dict[str, list[tuple[int, NDArray[np.float64]]]] = defaultdict(list)
        self._adjacency: list[Adjacency] = []
        self._schedules: list[PowerSchedule] = []
        self._events: list[Event] = []
        self._diagnostics: list[Diagnostics] = []
        self.takers = self._takers()

    def _takers(self) -> dict[str, Callable[[BagMessage, Any], None]]:
        """What is done with a message of each topic."""
        found: dict[str, Callable[[BagMessage, Any], None]] = {
            topics.LIFT_OFF: lambda _, m: self._lift_offs.append(decode_lift_off(m)),
            topics.EVENTS: lambda _, m: self._events.append(decode_event(m)),
            topics.ADJACENCY: lambda _, m: self._adjacency.append(decode_adjacency(m)),
            topics.POWER_SCHEDULE: lambda _, m: self._schedules.append(decode_power_schedule(m)),
            topics.DIAGNOSTICS: lambda _, m: self._diagnostics.append(decode_diagnostics(m)),
        }
        for uav in self.uav_ids:
            found[topics.pose(uav)] = partial(self._pose, uav)
            found[topics.trajectory(uav)] = lambda _, m: self._starts.append(
                decode_time(m.header.stamp)
            )
            found[topics.tx_power(uav)] = partial(self._power_step, uav, SETPOINT)
            found[topics.tx_power_applied(uav)] = partial(self._power_step, uav, READ_BACK)
        for topic in _AIR:
            found[topic] = lambda raw, m: self._air_report(raw.topic, m)
        return found

    def take(self, message: BagMessage) -> None:
        """Take a message in; one that is malformed is counted."""
        try:
            content = self._types.deserialize_cdr(message.data, message.type_name)
            self.takers[message.topic](message, content)
        except MessageError as error:
            self._malformed[f"{message.topic}: {_INDEX.sub('[]', str(error))}"] += 1
        except Exception as error:  # noqa: BLE001  bytes from a damaged file can fail in any way
            self._malformed[f"{message.topic}: {type(error).__name__}"] += 1

    def _pose(self, uav: str, raw: BagMessage, message: Any) -> None:
        pose = decode_pose(message)
        self._poses[uav].append((pose.stamp_ns, pose.position_m))
        self._clock.append((raw.stamp_ns, pose.stamp_ns))

    def _power_step(self, uav: str, source: str, raw: BagMessage, message: Any) -> None:
        self._power[uav, source].append((raw.stamp_ns, float(message.data)))

    def _air_report(self, topic: str, message: Any) -> None:
        _, rank = _AIR[topic]
        stamp_ns, uav_ids, values = decode_air_array(message, rank)
        if set(uav_ids) != set(self.uav_ids):
            raise MessageError("uav.ids", "names other UAVs than the plan")
        order = [uav_ids.index(uav) for uav in self.uav_ids]
        self._air[topic].append((stamp_ns, values[np.ix_(*[order] * rank)]))

    def flight(self, path: Path, broken: Sequence[BagError], *, complete: bool) -> RecordedFlight:
        """The whole flight; raises InputError where nothing tells when it began."""
        lift_off_ns, source = self._lift_off(path)
        clock = TimeMap([each[0] for each in self._clock], [each[1] for each in self._clock])
        notes = [str(error) for error in broken]
        notes += [f"{count} messages dropped, {what}" for what, count in self._malformed.items()]
        unseen = [uav for uav in self.uav_ids if uav not in self._poses]
        if unseen:
            notes.append(f"no poses of {', '.join(unseen)}")
        powers = {uav: self._steps(uav, clock, lift_off_ns) for uav in self.uav_ids}
        silent = [uav for uav, steps in powers.items() if steps.source == UNKNOWN]
        if silent:
            notes.append(f"no powers of {', '.join(silent)}")
        if not complete:
            notes.append("the recording was cut off, or begun again; what is there is whole")
        return RecordedFlight(
            uav_ids=self.uav_ids,
            lift_off_ns=lift_off_ns,
            lift_off_source=source,
            tracks={uav: self._track(uav, lift_off_ns) for uav in self.uav_ids},
            powers=powers,
            air={
                _AIR[topic][0]: _air_log(reports, lift_off_ns)
                for topic, reports in self._air.items()
            },
            adjacency=tuple(self._adjacency),
            schedules=tuple(self._schedules),
            events=tuple(sorted(dict.fromkeys(self._events), key=lambda each: each.stamp_ns)),
            troubles=troubles_of(self._diagnostics, lift_off_ns),
            complete=complete,
            notes=tuple(notes),
        )

    def _lift_off(self, path: Path) -> tuple[int, str]:
        if self._lift_offs:
            # Of another graph on the domain, where this plan's own was recorded too.
            tag = plan_tag(self.plan)
            own = [each for each in self._lift_offs if each[1] == tag] or self._lift_offs
            return own[-1][0], "as the vehicles' bridge announced it"
        planned_ns = max(self._starts, default=None)
        seen_ns = seen_lift_off_ns(self._poses, self.plan)
        if seen_ns is not None and (planned_ns is None or abs(seen_ns - planned_ns) > _APART_NS):
            return seen_ns, "as seen from the vehicles' climb: nobody announced it"
        if planned_ns is not None:
            return planned_ns, "as planned: the bag has no lift-off of the vehicles"
        raise InputError(
            f"{path}: holds nothing on {topics.LIFT_OFF} and no trajectory, so nothing tells when "
            "the flight began. Record with jfto run, or bag record --all from before the start."
        )

    def _track(self, uav: str, lift_off_ns: int) -> Track:
        samples = sorted(dict(self._poses.get(uav, [])).items())
        stamps = np.array([stamp for stamp, _ in samples], dtype=np.int64)
        places = np.array([place for _, place in samples], dtype=np.float64).reshape(-1, 3)
        return Track((stamps - lift_off_ns) / 1e9, places)

    def _steps(self, uav: str, clock: TimeMap, lift_off_ns: int) -> PowerSteps:
        """Powers in force: those read back, where the radio was asked at all."""
        for source in (READ_BACK, SETPOINT):
            samples = sorted(self._power.get((uav, source), []))
            if samples:
                received = np.array([stamp for stamp, _ in samples], dtype=np.int64)
                times_s = (clock.vehicles_ns(received) - lift_off_ns) / 1e9
                power_w = dbm_to_w(np.array([dbm for _, dbm in samples]))
                return PowerSteps(times_s, power_w, source)
        return PowerSteps(np.zeros(0), np.zeros(0), UNKNOWN)


def _air_log(reports: list[tuple[int, NDArray[np.float64]]], lift_off_ns: int) -> AirLog:
    by_time = sorted(dict(reports).items())
    stamps = np.array([stamp for stamp, _ in by_time], dtype=np.int64)
    return AirLog((stamps - lift_off_ns) / 1e9, np.stack([values for _, values in by_time]))


def troubles_of(said: Sequence[Diagnostics], lift_off_ns: int) -> tuple[Trouble, ...]:
    """Spells during which a node's status on a UAV, or on itself, was worse than OK.

    One that changes its level begins anew; the text is the spell's first.
    """
    open_spells: dict[tuple[str, str], Trouble] = {}
    ended: list[Trouble] = []
    for diagnostics in sorted(said, key=lambda each: each.stamp_ns):
        now_s = (diagnostics.stamp_ns - lift_off_ns) / 1e9
        for status in diagnostics.statuses:
            key = (diagnostics.node_name, status.uav_id)
            spell = open_spells.get(key)
            if spell is not None and _goes_on(spell, status, now_s):
                open_spells[key] = _longer(spell, now_s)
                continue
            if spell is not None:
                ended.append(open_spells.pop(key))
            if status.level != OK:
                open_spells[key] = Trouble(*key, status.level, status.text, now_s, now_s)
    return tuple(sorted([*ended, *open_spells.values()], key=lambda each: each.from_s))


def _goes_on(spell: Trouble, status: Status, now_s: float) -> bool:
    return status.level == spell.level and now_s - spell.to_s <= _SPELL_GAP_S


def _longer(spell: Trouble, now_s: float) -> Trouble:
    return Trouble(spell.node, spell.uav, spell.level, spell.text, spell.from_s, now_s)
