"""Rehearsals in virtual time."""

from __future__ import annotations

import pytest

from jfto_mavlink.errors import RosterError
from jfto_mavlink.protocol.command import set_mode
from jfto_mavlink.protocol.transfer import download
from jfto_sim import LinkFaults, Vehicle, VehicleConfig
from support.rehearsal import Rehearsal


def run(seed: int) -> bytes:
    """Everything said on a lossy link in 20 s, both directions."""
    heard = bytearray()
    loss = LinkFaults(loss=0.2, jitter_s=0.02)
    rehearsal = Rehearsal(
        {"uav1": Vehicle(VehicleConfig())},
        to_vehicle=loss,
        from_vehicle=loss,
        seed=seed,
        log=lambda _uav, raw: heard.extend(raw),
    )
    rehearsal.advance(5.0)
    rehearsal.run({"uav1": download})
    rehearsal.advance(15.0)
    return bytes(heard)


def test_the_same_seed_gives_the_same_bytes():
    """And another seed others: loss is drawn from it alone, no clock is read."""
    assert run(1) == run(1)
    assert run(1) != run(2)


def test_time_stands_still_between_steps():
    """Only `advance`, `until` and `run` move it."""
    rehearsal = Rehearsal({"uav1": Vehicle(VehicleConfig())})
    rehearsal.advance(2.0)
    assert rehearsal.clock() == pytest.approx(2.0)
    assert not rehearsal.until(lambda: False, 1.0)
    assert rehearsal.clock() == pytest.approx(3.0, abs=0.006)
    assert rehearsal.vehicles["uav1"].time_s == pytest.approx(3.0, abs=0.006)


def test_work_for_a_vehicle_that_is_not_there_is_an_error_of_its_own():
    """The others are worked with all the same."""
    rehearsal = Rehearsal({"uav1": Vehicle(VehicleConfig())})
    rehearsal.advance(2.0)
    results = rehearsal.run({"uav1": lambda c: set_mode(c, 4), "uav9": lambda c: set_mode(c, 4)})
    assert results["uav1"] is None
    assert isinstance(results["uav9"], RosterError)
