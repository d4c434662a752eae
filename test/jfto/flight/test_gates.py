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
    real = Gates((2,), 100.0).parameters(None)
    assert real["gates"] == (2,)
    assert real["start_at_s"] == pytest.approx(time.time() + 100.0, abs=2.0)
    start_s = time.time() - 360.0
    fleet = {"speedup": 10.0, "start_time_s": start_s}
    simulated = Gates((2,), 100.0).parameters(fleet)
    assert simulated["start_at_s"] == pytest.approx(start_s + 3600.0 + 100.0, abs=20.0)
