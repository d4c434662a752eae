"""Time gates as the command line names them, and as the bridge gets them."""

from __future__ import annotations

import time

import pytest

from jfto.flight.gates import Gates, parse_gates
from jfto_msgs_py.errors import InputError


def test_gates_are_waypoints_and_perhaps_a_lead() -> None:
    """Numbers from 1 on; the seconds behind @ are until lift-off."""
    assert parse_gates("3") == Gates((3,))
    assert parse_gates("3,6@300") == Gates((3, 6), 300.0)
    for wrong in ("", "0", "a", "3@", "3@5"):
        with pytest.raises(InputError, match="must be numbers of waypoints"):
            parse_gates(wrong)


def test_lift_off_is_in_the_vehicles_time() -> None:
    """Simulated ones may be an hour ahead of the wall, and gain on it."""
    before_s = time.time()
    real = Gates((2,), 100.0).parameters(None)
    fleet = {"speedup": 10.0, "start_time_s": before_s - 360.0}
    simulated = Gates((2,), 100.0).parameters(fleet)
    passed_s = time.time() - before_s
    assert real["gates"] == (2,)
    assert 100.0 <= real["start_at_s"] - before_s <= 100.0 + passed_s
    ahead_s = simulated["start_at_s"] - fleet["start_time_s"]
    assert 3700.0 <= ahead_s <= 3700.0 + 10 * passed_s + 1e-3
