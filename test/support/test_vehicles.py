"""The fixture that starts vehicles of either kind gives what it promises."""

from __future__ import annotations

from support.vehicles import Starter


def test_each_vehicle_is_reached_by_its_link_and_by_a_pilot(vehicles: Starter):
    """Two vehicles: a link each, and a hand on either; parameters are those asked for."""
    two = vehicles(2, parameters={"RTL_ALT": 4200.0})
    assert len(two.links) == 2
    for number in (1, 2):
        pilot = two.pilot(number)
        assert pilot.last("HEARTBEAT").get_srcSystem() == number
        assert pilot.parameter("RTL_ALT") == 4200.0


def test_powering_one_vehicle_off_leaves_the_other(vehicles: Starter):
    """The other one flies on."""
    two = vehicles(2)
    first, second = two.pilot(1), two.pilot(2)
    first.last("HEARTBEAT")
    two.kill(1)
    for _ in range(2):
        second.wait_type("HEARTBEAT")


def test_a_pilot_flies_either_kind(pilots):
    """Ready, armed, up: by messages alone."""
    pilot = pilots(DISARM_DELAY=0)
    pilot.take_off(10.0)
    assert pilot.armed
    assert abs(pilot.height_m - 10.0) < 0.5
