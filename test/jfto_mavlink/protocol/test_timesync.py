"""A vehicle's clock against ours, and time-outs from round trips."""

from __future__ import annotations

import random

import pytest

from jfto_mavlink.protocol.timesync import NS, RoundTrip, TimeSync


def test_offset_round_trip_and_jitter_are_found_in_noise():
    """The sample with the shortest round trip is nearly right, however long others take."""
    rng, sync, offset_s = random.Random(1), TimeSync(), 1234.5
    for n in range(16):
        there, back = 0.01 + rng.expovariate(20), 0.01 + rng.expovariate(20)
        sent = n * 1.0
        arrived = sent + there + offset_s
        sync.answer(int(sent * NS), int(arrived * NS), int((sent + there + back) * NS))
    assert sync.offset_s == pytest.approx(offset_s, abs=0.02)
    assert 0.02 < sync.round_trip.smoothed_s < 0.3
    assert sync.jitter_s > 0


def test_utc_error_allows_for_half_the_round_trip():
    """SYSTEM_TIME is half a round trip old when it arrives; 0 means no UTC yet."""
    sync = TimeSync()
    sync.system_time(0, 1000.0)
    assert sync.utc_error_s is None
    sync.round_trip.measure(0.2)
    sync.system_time(int(999.9e6), 1000.0)
    assert sync.utc_error_s == pytest.approx(0.0, abs=1e-6)


def test_a_reboot_forgets_the_offset():
    """The boot clock starts again."""
    sync = TimeSync()
    sync.answer(0, 5 * NS, NS // 100)
    assert sync.offset_s is not None
    sync.restart()
    assert sync.offset_s is None


def test_an_answer_from_the_future_is_ignored():
    """Only our own TIMESYNC can be answered."""
    sync = TimeSync()
    sync.answer(10 * NS, 0, 5 * NS)
    assert sync.samples == 0


def test_a_vehicle_clock_that_goes_back_is_a_reboot():
    """Late answers are not; neither is a simulation that stalls, however fast it ran before."""
    sync = TimeSync()
    assert not sync.answer(-9 * NS, 10 * NS, -9 * NS)
    assert not sync.answer(-4 * NS, 85 * NS, -4 * NS)
    assert not sync.answer(-NS, 85 * NS, -NS)
    assert not sync.answer(0, 100 * NS, NS // 100)
    assert not sync.answer(NS, int(100.2 * NS), NS + NS // 100)
    assert not sync.answer(2 * NS, int(99.0 * NS), 4 * NS)
    assert sync.answer(5 * NS, int(2.0 * NS), 5 * NS + NS // 100)
    assert sync.offset_s == pytest.approx(-3.0, abs=0.1)


def test_the_time_out_follows_the_link():
    """Short on a fast link, long on a slow one, bounded at both ends."""
    fast, slow, dead = RoundTrip(), RoundTrip(), RoundTrip()
    assert fast.timeout_s == fast.initial_s
    for _ in range(50):
        fast.measure(0.004)
        slow.measure(0.6)
        dead.measure(9.0)
    assert fast.timeout_s == fast.floor_s
    assert 0.6 < slow.timeout_s < 1.0
    assert dead.timeout_s == dead.ceiling_s


def test_an_impossible_sample_is_ignored():
    """A clock that went back says nothing about the link."""
    trip = RoundTrip()
    trip.measure(-1.0)
    assert trip.smoothed_s is None
