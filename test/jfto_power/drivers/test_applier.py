"""Setpoints on their way: rate, retries, what is found out by looking again."""

from __future__ import annotations

import pytest

from jfto_msgs_py.retry import Retry
from jfto_power.drivers import Applier, LogDriver, RadioError


class Radio(LogDriver):
    """A radio that can fail, or forget."""

    def __init__(self):
        self.lines = []
        self.broken = ""
        super().__init__(["uav1"], self.lines.append)

    def apply(self, uav_id, dbm):
        if self.broken:
            raise RadioError(self.broken)
        return super().apply(uav_id, dbm)

    def forget(self, dbm):
        self._set_dbm["uav1"] = dbm


@pytest.fixture
def radio():
    return Radio()


def test_setpoints_that_come_too_fast_wait_and_the_newest_wins(radio):
    """Of three within a second at one per second, the first and the last are set."""
    applier = Applier(radio, ["uav1"], interval_s=1.0)
    for now_s, dbm in ((0.0, 20.0), (0.2, 21.0), (0.4, 22.0)):
        applier.want("uav1", dbm)
        applier.step(now_s)
    assert radio.lines == ["uav1: tx power 20.00 dBm"]
    assert applier.step(0.99) == []
    (state,) = applier.step(1.0)
    assert (state.wanted_dbm, state.applied_dbm, state.trouble) == (22.0, 22.0, "")
    assert radio.lines[1:] == ["uav1: tx power 22.00 dBm"]


def test_nothing_is_done_before_a_setpoint(radio):
    """A radio is left alone until somebody wants something of it."""
    assert Applier(radio, ["uav1"]).step(1e9) == []


def test_a_failing_radio_is_tried_again_until_it_obeys(radio):
    """Every two seconds; the trouble is the driver's own words."""
    applier = Applier(radio, ["uav1"], retry=Retry(first_s=2.0, ceiling_s=2.0))
    radio.broken = "cable is out."
    applier.want("uav1", 20.0)
    (state,) = applier.step(0.0)
    assert (state.applied_dbm, state.trouble) == (None, "cable is out.")
    assert applier.step(1.9) == []
    assert applier.step(2.0)[0].trouble == "cable is out."
    radio.broken = ""
    (state,) = applier.step(4.0)
    assert (state.applied_dbm, state.trouble) == (20.0, "")


def test_a_radio_that_forgets_is_found_out_and_set_again(radio):
    """Looked at every ten seconds, it is read and only set where it differs."""
    applier = Applier(radio, ["uav1"], recheck_s=10.0)
    applier.want("uav1", 20.0)
    applier.step(0.0)
    applier.step(10.0)
    assert len(radio.lines) == 1
    radio.forget(30.0)
    (state,) = applier.step(20.0)
    assert (state.applied_dbm, state.trouble) == (20.0, "")
    assert len(radio.lines) == 2


def test_a_radio_that_does_something_else_is_in_trouble():
    """More than the tolerance away is said with both figures; within it is well."""

    class Stuck(Radio):
        def apply(self, uav_id, dbm):
            super().apply(uav_id, dbm)
            return 27.0

    applier = Applier(Stuck(), ["uav1"], tolerance_db=1.0)
    applier.want("uav1", 20.0)
    (state,) = applier.step(0.0)
    assert state.trouble == "It sends at 27.00 dBm where 20.00 dBm were set."
    applier.want("uav1", 26.0)
    assert applier.step(1.0)[0].trouble == ""
