"""The rule for batteries: the whole flight, from lift-off until the UAV stands at its pad."""

from __future__ import annotations

from dataclasses import replace

import pytest

from jfto_msgs_py.plan_file import plan_of_text, plan_text
from jfto_msgs_py.records.battery import Battery
from jfto_msgs_py.records.plan import Origin, Plan, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.records.way_home import WayHome
from jfto_planner.routing import PlanTerms, build_plan
from jfto_planner.routing.certificate.battery import check_battery
from jfto_world.motion.battery import Airborne, Drain, airborne


@pytest.fixture(name="there_and_back")
def _there_and_back() -> Plan:
    """600 m out at 10 m/s, 20 s of waiting, 600 m back, down within 21 s."""
    battery = Battery(10.0, 200.0, 300.0)
    pad, far = (0.0, 0.0, 0.0), (600.0, 0.0, 10.0)
    uav = Uav("uav1", 30.0, 1e6, 900.0, 10.0, 4.0, 3.0, pad, battery=battery)
    terms = PlanTerms(
        scenario_hash="there and back",
        seed=0,
        origin=Origin(36.0, -84.0, 0.0),
        radio=Radio(),
        k_min=0,
        delta=2,
        d_min_m=10.0,
        length_max_m=1e6,
        slot_count=10,
        horizon_s=None,
        waypoints=(Waypoint(0, far),),
        uavs=(uav,),
    )
    home = WayHome(20.0, (far, (0.0, 0.0, 10.0)), (80.0, 140.0), 161.0)
    return replace(build_plan([(0,)], terms), homes=(home,))


def test_the_whole_flight_counts(there_and_back):
    """Under way at cruise power, waiting and landing at hover power: 120 s and 41 s here."""
    flown = airborne(there_and_back, 0)
    assert flown == Airborne(120.0, 41.0)
    needed_wh = (120.0 * 300.0 + 41.0 * 200.0) / 3600.0
    (found,) = check_battery(there_and_back)
    assert (found.kind, found.uav, found.value) == ("battery", "uav1", pytest.approx(needed_wh))
    assert found.limit == pytest.approx(8.0)
    assert "Several sorties (sorties.count)" in found.message


@pytest.mark.parametrize(("capacity_wh", "clean"), [(15.3, False), (15.4, True)])
def test_the_reserve_is_left(there_and_back, capacity_wh, clean):
    """12.28 Wh are four fifths of 15.35 Wh."""
    uav = there_and_back.uavs[0]
    uavs = (replace(uav, battery=replace(uav.battery, capacity_wh=capacity_wh)),)
    assert (check_battery(replace(there_and_back, uavs=uavs)) == []) == clean


def test_wind_costs_half_of_its_share_of_the_speed(there_and_back):
    """At 10 m/s in 4 m/s of wind cruising takes a fifth more, standing no more."""
    calm, windy = (Drain(there_and_back.uavs[0].battery, 10.0, wind) for wind in (0.0, 4.0))
    assert windy.moving_w == pytest.approx(1.2 * calm.moving_w)
    assert windy.energy_wh(Airborne(0.0, 60.0)) == calm.energy_wh(Airborne(0.0, 60.0))
    flown = Airborne(windy.endurance_s(), 0.0)
    assert windy.left_s(flown) == pytest.approx(0.0, abs=1e-9)


def test_a_plan_keeps_its_batteries_in_its_file(there_and_back, tmp_path):
    """Written and read back; a plan without batteries says nothing of them."""
    text = plan_text(there_and_back)
    assert plan_of_text(text, tmp_path).uavs == there_and_back.uavs
    bare = replace(there_and_back, uavs=(replace(there_and_back.uavs[0], battery=None),))
    assert "battery" not in plan_text(bare)
    assert check_battery(bare) == []
