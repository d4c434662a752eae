"""A start of vehicles whose time passes faster than this computer's, as a simulation's may."""

from __future__ import annotations

import threading
import time

import pytest

from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.roster import parse_vehicles
from jfto_mavlink.flight.control import StartLine
from jfto_mavlink.guided.stream import take_off

UAVS = ("uav1", "uav2")
LIMIT_S = 90.0


@pytest.mark.slow(10)
def test_waits_before_a_start_count_the_vehicles_time(vehicles):
    """Armed 4 s of the vehicle's time ahead: it would disarm itself after 10 s (DISARM_DELAY)."""
    fleet = vehicles(2, speedup=4)
    with FleetLink(parse_vehicles((), UAVS, fleet.links)) as link:
        link.wait_heard(LIMIT_S)
        end_s, pause = time.monotonic() + LIMIT_S, threading.Event()
        while not all(link.vehicle(uav).prearm_ok for uav in UAVS):
            assert time.monotonic() < end_s
            pause.wait(0.1)
        line = StartLine(dict.fromkeys(UAVS, link.clock() + 6.0))
        results = link.run({uav: lambda context: take_off(context, line, 10.0) for uav in UAVS})
        assert results == {"uav1": None, "uav2": None}
        assert link.vehicle("uav1").height_m > 9.0
