"""Each check of a vehicle before its flight: what is fine, what is odd, what stops it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from jfto_mavlink.mission.fence import Circle, Fence, Polygon
from jfto_mavlink.preflight.endurance import battery, needed_s, speed
from jfto_mavlink.preflight.facts import Aboard, Snapshot, Surveyed
from jfto_mavlink.preflight.failsafe import failsafe
from jfto_mavlink.preflight.fence import fence
from jfto_mavlink.preflight.home import home
from jfto_mavlink.preflight.judge import changes, judge, parameters
from jfto_mavlink.preflight.pads import pads
from jfto_mavlink.preflight.page import (
    AMBER,
    GREEN,
    RED,
    Preflight,
    VehiclePage,
    read_page,
    write_page,
)
from jfto_mavlink.preflight.ready import on_board, unready, wind
from jfto_mavlink.preflight.settings import GateSettings
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.battery import Battery
from jfto_world.motion.battery import Drain

ON = {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 7.0, "FENCE_ALT_MAX": 100.0, "FENCE_RADIUS": 300.0}
HOME = (47.397742, 8.545594)


def square(half_m: float) -> Polygon:
    """A square about home."""
    north, east = half_m / 111_200, half_m / 75_400
    corners = ((north, east), (north, -east), (-north, -east), (-north, east))
    return Polygon(tuple((HOME[0] + n, HOME[1] + e) for n, e in corners))


def _takes(power_w: float, capacity_wh: float = 0.0) -> Drain:
    """A UAV of which little but its hover power is known."""
    return Drain(Battery(capacity_wh, power_w, power_w), speed_mps=8.0)


@pytest.mark.parametrize(
    ("set_", "figures", "level", "words"),
    [
        ({"FENCE_ENABLE": 0.0}, Fence(), GREEN, "its fence is off"),
        ({}, Fence((square(280.0),)), GREEN, "inside its fence"),
        ({"FENCE_ALT_MAX": 30.0}, Fence(), RED, "climbs to 45 m, FENCE_ALT_MAX is 30 m"),
        ({"FENCE_ALT_MAX": 46.0}, Fence(), AMBER, r"within 1\.\d m of its fence"),
        ({"FENCE_RADIUS": 100.0}, Fence(), RED, "flies 20. m from home, FENCE_RADIUS is 100 m"),
        ({"FENCE_TYPE": 8.0, "FENCE_ALT_MIN": 20.0}, Fence(), RED, "FENCE_ALT_MIN is 20 m"),
        ({}, Fence((square(100.0),)), RED, r"out of polygon 1 that it must stay in"),
        ({}, Fence(circles=(Circle(HOME, 50.0),)), RED, "out of circle 1"),
        ({"FENCE_ALT_MAX": 30.0, "FENCE_ACTION": 0.0}, Fence(), AMBER, "only reports it"),
        ({"FENCE_TYPE": 1.0}, Fence((square(100.0),)), GREEN, "inside its fence"),
    ],
)
def test_the_mission_is_held_against_the_fence_on_board(make_case, set_, figures, level, words):
    """FIELD 4: ceiling, floor, circle and figures, margin and action, before anybody breaches."""
    found = list(fence(make_case({**ON, **set_}, fence=figures)))
    assert max(found, key=lambda f: (GREEN, AMBER, RED).index(f.level)).level == level
    assert any(re.search(words, finding.text) for finding in found)
    assert all(finding.cure for finding in found if finding.level != GREEN)


@pytest.mark.parametrize(
    ("items", "card_kb", "level", "words"),
    [
        (650, 0.0, None, ""),
        (700, 0.0, AMBER, "700 items; boards hold 650 at least"),
        (700, 64.0, None, ""),
        (700, 8.0, RED, "its card is to hold 545"),
    ],
)
def test_a_mission_is_held_against_what_the_autopilot_keeps(
    make_case, items, card_kb, level, words
):
    """What a card is to hold is a parameter; of its own memory an autopilot says nothing."""
    case = make_case({"BRD_SD_MISSION": card_kb})
    own = case.mission.mission
    more = own.items + own.items[2:3] * (items - len(own.items))
    mission = replace(case.mission, mission=replace(own, items=more))
    found = list(on_board(replace(case, mission=mission)))
    assert [each.level for each in found] == ([] if level is None else [level])
    assert all(words in each.text and each.cure for each in found)


def test_a_fence_that_cannot_be_read_stops_the_flight(make_case):
    """Nobody knows what it forbids."""
    (found,) = fence(make_case(ON, unread="its fence could not be read"))
    assert found.level == RED


@pytest.mark.parametrize(
    ("given", "level", "words"),
    [
        ({}, AMBER, "nobody can judge"),
        ({"drains": {"uav1": _takes(300.0)}}, GREEN, "of reserve"),
        ({"drains": {"uav1": _takes(900.0)}}, RED, "of reserve"),
        ({"endurance_s": {"uav1": 600.0}}, GREEN, "flies 750 s"),
        ({"endurance_s": {"uav1": 100.0}}, RED, "flies 125 s"),
    ],
)
def test_the_charge_must_last_for_the_way_home_and_a_reserve(make_case, given, level, words):
    """FIELD 11: by hover power and capacity, or by endurance; said where nobody can judge."""
    (found,) = battery(make_case(settings=given))
    assert (found.level, words in found.text) == (level, True)


@pytest.mark.parametrize("percent", [10, 49, None])
def test_without_a_figure_a_half_empty_battery_still_stops(make_case, percent):
    """Below 50 %; unknown is to be looked at."""
    (found,) = battery(make_case(now={"battery_percent": percent}))
    assert found.level == (AMBER if percent is None else RED)


def test_a_capacity_that_the_vehicle_does_not_tell_is_the_plans(make_case):
    """fleet.battery_wh stands in for BATT_CAPACITY; wind and cruise power count as in the plan."""
    drain = Drain(Battery(100.0, 300.0, 600.0), speed_mps=8.0, wind_mps=4.0)
    (found,) = battery(make_case({"BATT_CAPACITY": 0.0}, settings={"drains": {"uav1": drain}}))
    # A hundred watt-hours at 600 W and a quarter more for the wind.
    assert "a full one flies 480 s" in found.text


def test_the_time_needed_has_the_way_home_in_it(make_case):
    """RTL climbs, returns, waits and lands slowly: a minute and more beyond the plan."""
    case = make_case()
    assert needed_s(case) > case.mission.ends_s + 40.0


@pytest.mark.parametrize(
    ("told", "limit", "level"),
    [
        (2.0, 3.0, GREEN),
        (4.0, 3.0, AMBER),
        (8.0, 3.0, RED),
        (None, 3.0, AMBER),
        (8.0, None, GREEN),
        (0.0, 3.0, AMBER),
    ],
)
def test_wind_is_held_against_what_was_planned_for(make_case, told, limit, level):
    """FIELD 7: 8 m/s where 3 were planned for is said, and stops."""
    (found,) = wind(make_case(now={"wind_mps": told}, settings={"wind_max_mps": limit}))
    assert found.level == level
    assert level != RED or "trajectory.wind_mps 8" in found.cure


def test_faster_than_the_owner_set_is_to_be_looked_at(make_case):
    """WPNAV_SPEED and its like, in the units of 4.5 whatever the firmware calls them."""
    slow = {"WPNAV_SPEED": 500.0, "WPNAV_SPEED_UP": 500.0, "WPNAV_SPEED_DN": 500.0}
    (found,) = speed(make_case(slow))
    assert (found.level, "WPNAV_SPEED 5 m/s" in found.text) == (AMBER, True)
    fast = dict.fromkeys(slow, 2000.0)
    assert [f.level for f in speed(make_case(fast))] == [GREEN]


@pytest.mark.parametrize(
    ("set_", "level", "words"),
    [
        ({"BATT_FS_LOW_ACT": 2.0, "BATT_FS_CRT_ACT": 0.0}, GREEN, "battery low: home"),
        ({"BATT_FS_LOW_ACT": 0.0}, AMBER, "a low battery does nothing"),
        ({"BATT_FS_LOW_ACT": 5.0}, RED, "stops the motors"),
        ({"BATT_FS_LOW_ACT": 2.0, "BATT_LOW_VOLT": 0.0}, AMBER, "never acts"),
        ({"BATT_FS_LOW_ACT": 2.0, "FS_THR_ENABLE": 0.0}, AMBER, "remote control"),
        ({"BATT_FS_LOW_ACT": 2.0, "FS_EKF_ACTION": 0.0}, AMBER, "lost position"),
    ],
)
def test_failsafes_are_shown_and_odd_ones_warned_of(make_case, set_, level, words):
    """One line says what it does by itself; each odd setting has its own, with a cure."""
    found = list(failsafe(make_case(set_)))
    assert any(finding.level == level and words in finding.text for finding in found)
    # One verdict per subject: what has a line of its own is not called fine beside it.
    assert ("battery low:" in found[-1].text) == (set_["BATT_FS_LOW_ACT"] == 2.0)


def test_a_guided_vehicle_without_its_station_hovers(make_case):
    """FS_GCS_ENABLE 0 is fine for missions, which end by themselves."""
    low = {"BATT_FS_LOW_ACT": 2.0}
    assert all(f.level == GREEN for f in failsafe(make_case(low)))
    levels = [f.level for f in failsafe(make_case(low, settings={"guided": True}))]
    assert AMBER in levels


@pytest.mark.parametrize(
    ("hill_m", "rtl_alt", "level"),
    [(0.0, 6000.0, GREEN), (50.0, 6000.0, AMBER), (70.0, 6000.0, RED), (70.0, 9500.0, GREEN)],
)
def test_rtl_must_clear_the_ground_from_everywhere(make_case, hill_m, rtl_alt, level):
    """A hill between the route and the pad, against RTL_ALT."""

    def ground(east, north):
        return np.where(np.hypot(east - 60.0, north) < 25.0, hill_m, 0.0)

    case = make_case({"RTL_ALT": rtl_alt, "RTL_CONE_SLOPE": 0.0}, settings={"ground": ground})
    (found,) = home(case)
    assert found.level == level
    assert level == GREEN or "RTL_ALT" in found.cure


def test_the_fence_caps_the_height_of_rtl(make_case):
    """As ArduCopter does it, silently: then the hill is met."""

    def ground(east, north):
        return np.where(np.hypot(east - 60.0, north) < 25.0, 70.0, 0.0)

    high = {"RTL_ALT": 9500.0, "RTL_CONE_SLOPE": 0.0, **ON, "FENCE_ALT_MAX": 60.0}
    (found,) = home(make_case(high, settings={"ground": ground}))
    assert found.level == RED
    assert "RTL_ALT 95 m, held down to 58 m by FENCE_ALT_MAX 60 m less its margin" in found.text
    assert "and raise FENCE_ALT_MAX above" in found.cure
    higher = {**high, "FENCE_ALT_MAX": 120.0, "RTL_ALT": 6000.0}
    (found,) = home(make_case(higher, settings={"ground": ground}))
    assert "below FENCE_ALT_MAX 120 m less its margin" in found.cure


@pytest.mark.parametrize(
    ("now", "waits", "stops"),
    [
        ({"gps_fix": 1}, ("position",), ()),
        ({"satellites": 3, "ekf_ready": False}, ("position", "position"), ()),
        ({"prearm_ok": False, "ekf_ready": False}, ("position", "autopilot"), ()),
        ({"prearm_ok": False}, (), ("autopilot",)),
        ({"prearm_ok": False, "prearm_texts": ("PreArm: GPS 1: Bad fix",)}, ("autopilot",), ()),
        ({"prearm_ok": False, "prearm_texts": ("PreArm: Gyros inconsistent",)}, ("autopilot",), ()),
        ({"prearm_ok": False, "prearm_texts": ("PreArm: RC not found",)}, (), ("autopilot",)),
        (
            {
                "prearm_ok": False,
                "prearm_texts": ("PreArm: AHRS: x", "PreArm: Compass not healthy"),
            },
            ("autopilot",),
            ("autopilot",),
        ),
        ({"armed": True}, (), ("autopilot",)),
        ({"fence_breached": True}, (), ("autopilot",)),
        ({"silent_s": 9.0}, (), ("autopilot",)),
    ],
)
def test_what_passes_by_itself_is_amber_until_nobody_waits(make_case, now, waits, stops):
    """Fix, estimate and what settles: amber where a run waits later, red at the gate's end."""
    looked = list(unready(make_case(now=now).now, GateSettings(waited_for=True)))
    assert tuple(f.topic for f in looked if f.waits) == waits
    assert tuple(f.topic for f in looked if f.level == RED) == stops
    assert all((f.level, "run waits for it" in f.text) == (AMBER, True) for f in looked if f.waits)
    at_last = list(unready(make_case(now=now).now, GateSettings()))
    assert [f.level for f in at_last] == [RED] * len(looked)
    assert not any(f.waits for f in at_last)


def test_parameters_are_told_old_to_new(make_case):
    """FIELD 10: listed before anything is changed; what the firmware lacks stops the flight."""
    case = make_case()
    assert [str(change) for change in changes(case)] == ["WPNAV_RADIUS 200 → 120"]
    assert "WPNAV_RADIUS 200 → 120" in [f.text for f in parameters(case)][-1]
    case.aboard.parameters.pop("WPNAV_RADIUS")
    assert next(iter(parameters(case))).level == RED


def at(east_m: float, up_m: float = 0.0) -> tuple[float, float, float]:
    """A place east of home."""
    return (HOME[0], HOME[1] + east_m / 75_400, 488.0 + up_m)


@pytest.mark.parametrize(
    ("places", "levels", "words"),
    [
        ((at(0.5), at(10.0)), (GREEN, GREEN), "on its pad"),
        ((at(10.5), at(0.0)), (RED, RED), "m from that of"),
        ((at(4.9), at(10.5)), (RED, GREEN), "at most 4.7 m"),
        ((at(0.0, 300.0), at(10.5, 300.0)), (RED, RED), "above its planned pad"),
        ((at(0.0, 300.0), at(10.5)), (RED, GREEN), "above its planned pad"),
        ((at(0.0, 60.0), at(10.5, 60.0)), (AMBER, AMBER), "height is"),
        ((at(0.0, 20.0), at(10.5)), (RED, GREEN), "than the others do"),
        ((None, at(10.5)), (AMBER, GREEN), "not known yet"),
    ],
)
def test_each_stands_nearest_to_its_own_pad_and_at_its_height(places, levels, words):
    """FIELD 5 and 18: pads 10.5 m apart; swapped, between, on another level, on a wrong datum."""
    homes = {"uav1": at(0.0), "uav2": at(10.5)}
    found = pads(homes, dict(zip(homes, places, strict=True)), 15.0)
    assert tuple(found[uav][0].level for uav in homes) == levels
    assert words in found["uav1"][0].text


def test_a_page_is_kept_as_it_is_and_strictly(make_case, tmp_path):
    """What another program reads is what was found; a broken one is refused by name."""
    case = make_case()
    page = Preflight((VehiclePage("uav1", tuple(fence(case)), changes(case)),))
    write_page(page, tmp_path / "page.json")
    assert read_page(tmp_path / "page.json") == page
    (tmp_path / "page.json").write_text('{"format": "jfto-preflight", "version": 1}')
    with pytest.raises(InputError, match="lacks vehicles"):
        read_page(tmp_path / "page.json")


def test_a_vehicle_never_heard_has_one_line(make_case):
    """Nothing is known of it: no check is called fine, and no unknown figure is shown."""
    case = make_case()
    found = {case.mission.uav: Surveyed(Snapshot(np.inf), Aboard(unread="no parameter"))}
    page = judge({case.mission.uav: case.mission}, found, case.settings)
    (line,) = page.vehicles[0].findings
    assert (line.level, line.text) == (RED, "not heard on its link")
    assert line.cure
