"""Rates of messages."""

from __future__ import annotations

from jfto.ros_cli.hz import RateMeter


def _reports(meter, period_ns, count):
    reports = []
    for index in range(count):
        meter.add(1 + index * period_ns)
        text = meter.report()
        if text is not None:
            reports.append(text)
    return reports


def test_rate_is_printed_once_a_second_of_message_time():
    """The first text comes a second after the first interval, then one a second, growing."""
    reports = _reports(RateMeter(10000), 10**8, 35)
    assert reports[0] == (
        "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: 11"
    )
    assert [text.rpartition(" ")[2] for text in reports] == ["11", "21", "31"]


def test_window_keeps_the_newest():
    """No more than so many intervals count."""
    meter = RateMeter(3)
    reports = _reports(meter, 5 * 10**8, 8)
    assert {text.rpartition(" ")[2] for text in reports[1:]} == {"3"}


def test_clock_that_jumps_back_starts_anew():
    """Intervals from before a jump back are forgotten."""
    meter = RateMeter(100)
    _reports(meter, 10**9, 5)
    meter.add(1)
    assert meter.report() is None


def test_single_message_has_no_rate():
    """One message makes no interval."""
    meter = RateMeter(10)
    meter.add(5)
    assert meter.report() is None
