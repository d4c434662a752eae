"""What counts as a difference between a replay and its recording."""

from __future__ import annotations

import math

import numpy as np
import pytest
from std_msgs.msg import Float64

from jfto.bag.comparison import Stamped, compare_topic
from jfto_msgs_py.records.network import Adjacency, PowerSchedule, SlotHorizon
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.network import encode_adjacency, encode_power_schedule

IDS = ("uav1", "uav2")
SECOND = 10**9


def _schedule(first, power_w):
    horizon = SlotHorizon(first, first * SECOND, 1.0, 1)
    message = encode_power_schedule(PowerSchedule(horizon, IDS, np.array([power_w])))
    return Stamped(first * SECOND, message)


def _adjacency(first, linked, late_ns=0):
    links = np.array([[[False, linked], [linked, False]]])
    horizon = SlotHorizon(first, first * SECOND + late_ns, 1.0, 1)
    return Stamped(first * SECOND, encode_adjacency(Adjacency(horizon, IDS, links)))


def _setpoints(*pairs):
    return [Stamped(round(at_s * SECOND), Float64(data=dbm)) for at_s, dbm in pairs]


def test_powers_may_differ_by_the_tolerance_and_no_more():
    """0.04 dB is within 0.05 dB; 0.06 dB is not, and the slot is named."""
    recorded = [_schedule(3, [0.1, 0.2])]
    within = compare_topic(
        topics.POWER_SCHEDULE, recorded, [_schedule(3, [0.1 * 10**0.004, 0.2])], 0.05
    )
    assert within.problems == ()
    assert within.worst == pytest.approx(0.04)
    beyond = compare_topic(
        topics.POWER_SCHEDULE, recorded, [_schedule(3, [0.1 * 10**0.006, 0.2])], 0.05
    )
    assert len(beyond.problems) == 1
    assert "slot 3 " in beyond.problems[0]


def test_power_that_became_zero_is_infinitely_far():
    """A radio that is off is no small difference; off and off is none at all."""
    on, off = [_schedule(1, [0.1, 0.1])], [_schedule(1, [0.1, 0.0])]
    assert compare_topic(topics.POWER_SCHEDULE, on, off, 1e9).worst == math.inf
    assert compare_topic(topics.POWER_SCHEDULE, off, off, 0.0).problems == ()


def test_one_link_is_one_too_many():
    """Links have no tolerance."""
    found = compare_topic(topics.ADJACENCY, [_adjacency(1, True)], [_adjacency(1, False)], 1e9)
    assert (found.worst, len(found.problems)) == (1.0, 1)


def test_slots_that_are_missing_or_too_many_are_named():
    """A slot that only one side has is a fault, except outside the recording."""
    recorded = [_adjacency(2, True), _adjacency(4, True)]
    replayed = [_adjacency(first, True) for first in (1, 3, 4, 5)]
    found = compare_topic(topics.ADJACENCY, recorded, replayed, 0.05)
    assert len(found.problems) == 2
    assert "slot 2 " in found.problems[0]
    assert "slot 3 " in found.problems[1]


def test_a_slot_that_was_shifted_a_little_otherwise_is_the_same_slot():
    """Slots shift with the fleet: up to a quarter of their length is the order of messages."""
    recorded = [_adjacency(2, True), _adjacency(3, True)]
    little = [_adjacency(2, True, SECOND // 5), _adjacency(3, True, -SECOND // 5)]
    found = compare_topic(topics.ADJACENCY, recorded, little, 0.0)
    assert (found.problems, found.compared, found.worst) == ((), 2, 0.0)
    much = [_adjacency(2, True), _adjacency(3, True, SECOND // 3)]
    found = compare_topic(topics.ADJACENCY, recorded, much, 0.0)
    assert found.compared == 1
    assert "slot 3 at 3.000 s was recorded, but not replayed." in found.problems


def test_the_last_slot_may_be_solved_again_and_again():
    """Each time is compared with the one nearest to it."""
    times_ns = (0, SECOND, 2 * SECOND)
    recorded = [
        _adjacency(7, linked, late)
        for linked, late in zip((True, False, True), times_ns, strict=True)
    ]
    found = compare_topic(topics.ADJACENCY, recorded, recorded[::-1], 0.0)
    assert (found.problems, found.compared) == ((), 3)


def test_setpoints_in_force_are_compared_and_jitter_is_not():
    """A change 10 ms later is the same run; another value for a second is not."""
    recorded = _setpoints((1.0, 20.0), (2.0, 21.0), (3.0, 22.0))
    jitter = compare_topic(
        "/uav1/jfto/tx_power", recorded, _setpoints((1.01, 20.0), (1.99, 21.0), (3.0, 22.0)), 0.05
    )
    assert (jitter.problems, jitter.compared) == ((), 3)
    other = compare_topic(
        "/uav1/jfto/tx_power", recorded, _setpoints((1.0, 20.0), (2.0, 21.5), (3.0, 22.0)), 0.05
    )
    assert other.worst == pytest.approx(0.5)
    assert len(other.problems) == 1


def test_nothing_to_compare_is_a_fault():
    """A node that is silent in the replay does not pass."""
    recorded = _setpoints((1.0, 20.0))
    assert compare_topic("/uav1/jfto/tx_power", recorded, [], 0.05).problems
    assert compare_topic(topics.ADJACENCY, [_adjacency(1, True)], [], 0.05).problems
