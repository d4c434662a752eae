"""Orders to one vehicle of a fleet in flight, and what is told of it, in virtual time."""

from __future__ import annotations

import dataclasses

import pytest

from jfto_mavlink.dialect import MODES, mavlink
from jfto_mavlink.errors import CommandError, FlightError, TransferError
from jfto_mavlink.flight.control import (
    brake,
    change_mission,
    land,
    pause,
    resume,
    return_home,
)
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.deliver import deliver
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.protocol.command import send_command, set_mode
from jfto_msgs_py.records.event import WARN
from jfto_sim import LinkFaults
from support.rehearsal import CLEAN
from support.rehearsed_fleet import RehearsedFleet


@pytest.mark.slow
def test_pause_and_resume_reach_the_end(plan):
    """Paused it stands, resumed it goes on with the same waypoint."""
    field = RehearsedFleet(plan)
    field.take_off()
    vehicle = field.runner.station.vehicle("uav1")
    assert field.runner.until(lambda: (vehicle.mission_current or 0) > 6, 60.0)
    field.do("uav1", pause)
    field.runner.advance(6.0)
    assert sum(v * v for v in vehicle.velocity_ned_mps) < 0.3**2
    field.do("uav1", resume)
    assert field.until_down()
    assert field.missed("uav1", 2.0) == []


def test_only_a_mission_can_be_paused(plan):
    """In another mode the pause says so instead of doing nothing."""
    field = RehearsedFleet(plan)
    with pytest.raises(FlightError, match="STABILIZE"):
        field.do("uav1", pause)


@pytest.mark.slow
@pytest.mark.parametrize(("job", "mode"), [(return_home, "RTL"), (land, "LAND"), (brake, "BRAKE")])
def test_aborts_are_seen_to_work(plan, job, mode):
    """Each ends in the mode it asks for, and that is told."""
    field = RehearsedFleet(plan)
    field.take_off()
    field.do("uav1", job)
    assert field.runner.station.vehicle("uav1").mode == MODES[mode]
    if mode != "BRAKE":
        assert field.until_down()
        field.runner.advance(1.0)
        assert field.landed("uav1")
        assert f"mode {mode}" in [event.text for event in field.events]
        assert field.missed("uav1", 2.0) != []


def test_a_mission_is_not_written_over_in_auto(plan):
    """There each stored item restarts the leg, and half a mission could fly."""
    field = RehearsedFleet(plan)
    field.take_off()
    mission = field.missions["uav1"].mission
    with pytest.raises(TransferError, match="AUTO") as caught:
        field.do("uav1", lambda context: deliver(context, mission))
    assert caught.value.code == 405


@pytest.mark.slow
def test_a_changed_mission_in_flight_holds_first_and_starts_at_its_first_item(plan):
    """BRAKE, upload, read back, current item set, AUTO again."""
    field = RehearsedFleet(plan)
    field.take_off()
    vehicle = field.runner.station.vehicle("uav1")
    assert field.runner.until(lambda: (vehicle.mission_current or 0) > 8, 60.0)
    new = build_missions(plan, MissionSettings(style="hold"))[0]
    delivered = field.do("uav1", lambda context: change_mission(context, new.mission))
    assert delivered.digest == new.digest
    field.runner.advance(1.0)
    modes = [e.text for e in field.events if e.kind == "mode"]
    assert modes[-2:] == ["mode BRAKE", "mode AUTO"]
    field.runner.advance(1.0)
    assert vehicle.mission_current < 8
    assert field.until_down()


def test_a_refused_change_in_flight_puts_the_old_mission_back(plan):
    """The vehicle goes on holding with the mission it had, and the error says so."""
    field = RehearsedFleet(plan)
    field.take_off()
    before = list(field.runner.vehicles["uav1"].store.mission)
    items = field.missions["uav1"].mission.items
    bad = dataclasses.replace(
        field.missions["uav1"].mission,
        items=(*items[:6], dataclasses.replace(items[6], command=31_000), *items[7:]),
    )
    with pytest.raises(TransferError, match="restored"):
        field.do("uav1", lambda context: change_mission(context, bad))
    assert field.runner.vehicles["uav1"].store.mission[1:] == before[1:]
    assert field.runner.station.vehicle("uav1").mode == MODES["BRAKE"]


@pytest.mark.slow
def test_a_link_lost_in_flight_is_told_and_the_flight_goes_on(plan):
    """The vehicle flies its mission without us; waypoints passed unseen count as reached."""
    field = RehearsedFleet(plan, MissionSettings(style="hold"))
    field.take_off()
    field.runner.air.set_faults(1, LinkFaults(cut=True), LinkFaults(cut=True))
    field.runner.advance(20.0)
    assert any(event.text.startswith("uav1 is lost") for event in field.events)
    field.runner.air.set_faults(1, CLEAN, CLEAN)
    assert field.until_down()
    field.runner.advance(1.0)
    assert field.landed("uav1")
    passed = field.timings["uav1"].passed
    assert [p.waypoint_id for p in passed] == list(field.missions["uav1"].waypoint_ids)


@pytest.mark.slow
def test_a_low_battery_is_told(plan):
    """Published once, when it sinks below the mark."""
    field = RehearsedFleet(plan)
    field.take_off()
    vehicle = field.runner.vehicles["uav1"]
    vehicle.battery.consumed_mah = 0.88 * vehicle.params["BATT_CAPACITY"]
    field.runner.advance(3.0)
    told = [event for event in field.events if (event.kind, event.level) == ("battery", WARN)]
    assert [event.text for event in told] == ["uav1 has 11 % of its battery left and flies on."]


def test_a_command_refused_carries_the_vehicles_reason(plan):
    """Arming in AUTO is refused by the autopilot, in its own words."""
    field = RehearsedFleet(plan)

    def arm_in_auto(context):
        yield from set_mode(context, MODES["AUTO"])
        yield from send_command(context, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (1.0,))

    with pytest.raises(CommandError, match="AUTO mode not armable") as caught:
        field.do("uav1", arm_in_auto)
    assert caught.value.code == 503
