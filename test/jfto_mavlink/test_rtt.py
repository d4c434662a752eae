"""Time-outs from round trips."""

from __future__ import annotations

from jfto_mavlink.rtt import RoundTrip


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
