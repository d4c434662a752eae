"""The speed-up that simulated vehicles get where none is asked for."""

from __future__ import annotations

import os

import pytest

from jfto.flight.settings import default_speedup


@pytest.mark.parametrize(
    ("cores", "vehicles", "speedup"), [(2, 3, 10.0), (2, 8, 10.0), (1, 8, 5.0), (1, 100, 1.0)]
)
def test_a_greater_fleet_flies_slower_than_real_time_never(
    monkeypatch, cores, vehicles, speedup
) -> None:
    """At most 10, at least 1, between them by cores and vehicles."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _pid: set(range(cores)))
    assert default_speedup(vehicles) == speedup
