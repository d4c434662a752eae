"""What a replay gave against what was recorded."""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from jfto_msgs_py.records.network import SlotHorizon
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.multi_array import parse_slot_label

Pair = tuple[str, Any, Any]
# Two runs change a setpoint at the same slot, but not in the same millisecond.
_JITTER_NS = 250_000_000
# Nor do they agree on when a slot begins better than to this part of it.
_GAP_SLOTS = 0.25
_BEGINNING = re.compile("(?<=;)t0=[^;]*;?")


@dataclass(frozen=True)
class TopicComparison:
    """One output topic; `worst` is in `unit`, `problems` are sentences, empty if all is well."""

    topic: str
    recorded: int
    replayed: int
    compared: int
    worst: float
    unit: str
    problems: tuple[str, ...]


@dataclass(frozen=True)
class Stamped:
    """A message, decoded, and when it was published, ns."""

    stamp_ns: int
    message: Any


def compare_topic(
    topic: str, recorded: Sequence[Stamped], replayed: Sequence[Stamped], tolerance_db: float
) -> TopicComparison:
    """Compare the messages of a topic.

    Links must be the same; powers may differ by `tolerance_db`, two that are zero are equal.
    Messages of a horizon are paired by its first slot, the nearest in time where there are several;
    of setpoints, those in force are compared wherever both have been so for a while. What was
    replayed before the first or after the last recorded message is left out: the node or the
    recorder was not there.
    """
    if topic in {topics.ADJACENCY, topics.POWER_INTERVAL, topics.POWER_SCHEDULE}:
        compare = _links if topic == topics.ADJACENCY else _powers_db
        pairs, problems = _horizon_pairs(recorded, replayed)
    else:
        compare = _setpoint_db
        pairs, problems = _setpoint_pairs(recorded, replayed)
    unit, tolerance = ("links", 0.0) if compare is _links else ("dB", tolerance_db)
    worst = 0.0
    for name, one, other in pairs:
        deviation = compare(one, other)
        worst = max(worst, deviation)
        if deviation > tolerance:
            problems.append(f"{name} differs by {deviation:.6g} {unit}, allowed {tolerance:g}.")
    if recorded and not pairs:
        problems.append("nothing could be compared.")
    return TopicComparison(
        topic, len(recorded), len(replayed), len(pairs), worst, unit, tuple(problems)
    )


def _horizon_pairs(
    recorded: Sequence[Stamped], replayed: Sequence[Stamped]
) -> tuple[list[Pair], list[str]]:
    """Pairs of messages for one slot that begin together.

    Slots shift with the fleet as its poses are taken in: two runs agree on their beginning but for
    the order in which messages came.
    """
    left = list(replayed)
    pairs, problems = [], []
    for one in recorded:
        horizon = _horizon(one)
        near = [other for other in left if _gap_ns(horizon, _horizon(other)) is not None]
        if not near:
            problems.append(f"{_name(horizon)} was recorded, but not replayed.")
            continue
        other = min(near, key=lambda each: _gap_ns(horizon, _horizon(each)) or 0)
        left.remove(other)
        pairs.append((_name(horizon), one.message, other.message))
    if recorded:
        first_ns, last_ns = recorded[0].stamp_ns, recorded[-1].stamp_ns
        problems += [
            f"{_name(_horizon(each))} was replayed, but not recorded."
            for each in left
            if first_ns < each.stamp_ns < last_ns
        ]
    return pairs, problems


def _horizon(stamped: Stamped) -> SlotHorizon:
    dim = stamped.message.layout.dim[0]
    return parse_slot_label(dim.label, dim.size)


def _gap_ns(one: SlotHorizon, other: SlotHorizon) -> int | None:
    """Time between the beginnings of one and the same slot; None where that is too much."""
    gap_ns = abs(one.t0_ns - other.t0_ns)
    if one.first != other.first or gap_ns > _GAP_SLOTS * one.duration_s * 1e9:
        return None
    return gap_ns


def _name(horizon: SlotHorizon) -> str:
    return f"slot {horizon.first} at {horizon.t0_ns / 1e9:.3f} s"


def _setpoint_pairs(
    recorded: Sequence[Stamped], replayed: Sequence[Stamped]
) -> tuple[list[Pair], list[str]]:
    """Setpoints in force together for longer than the jitter of two runs."""
    if not recorded or not replayed:
        return [], []
    begin_ns = max(recorded[0].stamp_ns, replayed[0].stamp_ns)
    changes = {each.stamp_ns for each in (*recorded, *replayed)}
    moments = sorted(moment for moment in changes if moment >= begin_ns)
    pairs = []
    for moment_ns, after_ns in pairwise([*moments, moments[-1] + 2 * _JITTER_NS]):
        if after_ns - moment_ns > _JITTER_NS and moment_ns <= recorded[-1].stamp_ns + _JITTER_NS:
            one, other = _in_force(recorded, moment_ns), _in_force(replayed, moment_ns)
            pairs.append((f"setpoint at {moment_ns / 1e9:.3f} s", one, other))
    return pairs, []


def _in_force(messages: Sequence[Stamped], moment_ns: int) -> Any:
    return messages[bisect_right([each.stamp_ns for each in messages], moment_ns) - 1].message


def _links(one: Any, other: Any) -> float:
    if not _same_layout(one, other):
        return math.inf
    return float(np.count_nonzero(np.asarray(one.data) != np.asarray(other.data))) / 2


def _powers_db(one: Any, other: Any) -> float:
    if not _same_layout(one, other):
        return math.inf
    first, second = np.asarray(one.data, float), np.asarray(other.data, float)
    differs = first != second
    if not differs.any():
        return 0.0
    first, second = first[differs], second[differs]
    if (first <= 0).any() or (second <= 0).any():
        return math.inf
    return float(np.abs(10 * np.log10(first / second)).max())


def _setpoint_db(one: Any, other: Any) -> float:
    return 0.0 if one.data == other.data else abs(float(one.data) - float(other.data))


def _same_layout(one: Any, other: Any) -> bool:
    return _layout(one) == _layout(other)


def _layout(message: Any) -> list[tuple[str, int]]:
    """Labels and sizes of the dimensions, without when the first slot begins."""
    return [(_BEGINNING.sub("", dim.label), dim.size) for dim in message.layout.dim]
