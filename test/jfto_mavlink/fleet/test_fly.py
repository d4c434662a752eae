"""Whole flights of a small fleet in virtual time, good ones and bad ones."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from jfto_mavlink.errors import FlightError
from jfto_mavlink.fleet.fly import FlySettings, preflight
from jfto_mavlink.fleet.orders import FleetOrders, OrderSettings
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.preflight.gate import inspect
from jfto_mavlink.preflight.judge import judge
from jfto_mavlink.preflight.settings import GateSettings
from jfto_sim import LinkFaults, Vehicle, VehicleConfig
from support.rehearsal import Rehearsal
from support.rehearsed_fleet import READY_S, RehearsedFleet


@pytest.mark.slow
@pytest.mark.parametrize("style", ["fly_through", "hold"])
def test_a_fleet_flies_its_plan_to_the_end(plan, style):
    """Every waypoint within 2 m, then home, landed, disarmed."""
    field = RehearsedFleet(plan, MissionSettings(style=style))
    for uav, passages in field.fly().items():
        assert field.landed(uav)
        assert field.missed(uav, 2.0) == []
        assert [p.waypoint_id for p in passages] == list(field.missions[uav].waypoint_ids)
        assert all(p.reached_s is not None for p in passages)
        home = field.missions[uav].home_deg_m
        vehicle = field.runner.station.vehicle(uav)
        assert abs(vehicle.lat_deg - home[0]) < 2e-6
        assert not vehicle.armed


@pytest.mark.slow
def test_a_fleet_flies_over_a_bad_link(plan):
    """30 % loss each way costs patience, not waypoints."""
    loss = LinkFaults(loss=0.3)
    field = RehearsedFleet(plan, to_vehicle=loss, from_vehicle=loss, seed=2)
    for uav in field.fly():
        assert field.landed(uav)
        assert field.missed(uav, 2.5) == []


@pytest.mark.slow
def test_time_gates_hold_the_fleet_to_the_clock(plan):
    """Flown once for true times, then gated: each vehicle leaves its gate at the planned second."""
    first = RehearsedFleet(plan)
    records = first.fly()
    routes = tuple(
        dataclasses.replace(route, arrival_s=tuple(p.reached_s for p in records[uav.id]))
        for uav, route in zip(plan.uavs, plan.routes, strict=True)
    )
    timed = dataclasses.replace(plan, routes=routes)
    lead_s = 30.0
    start_unix_s = VehicleConfig().utc_at_boot_us / 1e6 + READY_S + lead_s
    settings = MissionSettings(gates=(0,), start_unix_s=start_unix_s)
    field = RehearsedFleet(timed, settings)
    left = {}

    def watch(event_uav, vehicle, delay_seq):
        if event_uav not in left and (vehicle.mission_current or 0) > delay_seq:
            left[event_uav] = field.runner.vehicles[event_uav].utc_us / 1e6

    gate_seq = {u: m.item_map.items[0] + 2 for u, m in field.missions.items()}
    tick = field.runner.station.tick

    def tick_and_watch():
        tick()
        for uav, seq in gate_seq.items():
            watch(uav, field.runner.station.vehicle(uav), seq)

    field.runner.station.tick = tick_and_watch
    field.fly(FlySettings(start_at_s=READY_S + lead_s))
    for uav, route in zip(plan.uavs, routes, strict=True):
        planned = np.ceil(start_unix_s + route.arrival_s[0] + settings.gate_slack_s)
        assert left[uav.id] == pytest.approx(planned, abs=0.6)


def test_a_fleet_ready_too_late_for_its_gates_stays_on_the_ground(plan):
    """A start in the past would desynchronise everything."""
    with pytest.raises(FlightError, match="too late for its time gates"):
        RehearsedFleet(plan).fly(FlySettings(start_at_s=READY_S + 1.0))


def test_an_order_to_start_waits_for_the_moment_of_the_gates(plan):
    """Lift-off at the second that the missions count from; an order too late arms nobody."""
    field = RehearsedFleet(plan)
    at_s = READY_S + 40.0
    away_s = [1.0]
    orders = FleetOrders(field.fleet, OrderSettings(True, start_away_s=lambda: away_s[0]))
    with pytest.raises(FlightError, match="too late for its time gates"):
        orders.start()
    assert not any(event.kind == "armed" for event in field.events)
    away_s[0] = at_s - field.runner.now_s
    assert orders.start() == "flying: uav1, uav2"
    started = [told_s for told_s, text in field.said if text.endswith("starts its mission")]
    assert started == pytest.approx([at_s, at_s], abs=0.5)


def test_a_vehicle_that_is_not_ready_keeps_all_on_the_ground(plan):
    """Its own words come through verbatim, and nobody is armed."""
    field = RehearsedFleet(plan)
    field.runner.vehicles["uav2"].battery.volts = 9.0
    field.runner.vehicles["uav2"].params.store("BATT_ARM_VOLT", 14.0)
    field.runner.advance(40.0)
    settings = FlySettings(gate=GateSettings(wait_s=5.0))
    with pytest.raises(FlightError, match="No vehicle is armed") as caught:
        field.fly(settings)
    assert "uav2" in str(caught.value)
    assert "uav1" not in str(caught.value)
    assert not any(event.kind == "armed" for event in field.events)


def test_a_mission_changed_on_board_after_its_release_is_noticed(plan):
    """Another station wrote it in between: the gate reads back once more."""
    field = RehearsedFleet(plan)
    store = field.runner.vehicles["uav1"].store
    store.put(7, store.mission[11])
    with pytest.raises(FlightError, match="uav1: mission on board: item 7"):
        field.fly()
    assert not any(event.kind == "armed" for event in field.events)


def test_only_the_released_mission_is_flown(plan):
    """A mission built anew, with other settings, needs a release of its own."""
    field = RehearsedFleet(plan)
    built = build_missions(plan, MissionSettings(style="hold"))
    field.missions = {mission.uav: mission for mission in built}
    with pytest.raises(FlightError, match="not the released mission"):
        field.fly()


def test_a_vehicle_that_does_not_arm_holds_the_others_back(plan):
    """Arming fails for one: the other disarms again, both say why."""
    field = RehearsedFleet(plan)
    runner = field.runner
    original = runner.vehicles["uav2"].arming.arm

    def refuse(*_args, **_kwargs):
        runner.vehicles["uav2"].ports.text(2, "Arm: Compass not healthy")
        return False

    runner.vehicles["uav2"].arming.arm = refuse
    with pytest.raises(FlightError, match="held back, because uav2") as caught:
        field.fly()
    assert "Arm: Compass not healthy" in str(caught.value)
    assert original is not None
    runner.advance(2.0)
    assert not any(runner.station.vehicle(uav).armed for uav in field.missions)
    assert not any(event.text == "mode AUTO" for event in field.events)


def test_the_gate_names_everything_that_is_missing_at_once(plan):
    """On a vehicle just switched on: position, fix, satellites."""
    built = build_missions(plan, MissionSettings())[0]
    runner = Rehearsal({"uav1": Vehicle(VehicleConfig())})
    runner.advance(3.0)
    settings = GateSettings(wait_s=1.0)
    surveyed = runner.run({"uav1": lambda context: inspect(context, built, settings)})
    found = judge({"uav1": built}, surveyed, settings).stops()
    assert any("GPS fix" in text for text in found)
    assert any("position estimate" in text for text in found)
    assert all(text.startswith("uav1: ") for text in found)


def test_a_vehicle_on_the_wrong_pad_is_refused(plan):
    """Swapped vehicles would cross each other's routes."""
    field = RehearsedFleet(plan)
    settings = GateSettings(wait_s=1.0)
    first, second = field.missions.values()
    field.missions = {"uav1": dataclasses.replace(first, home_deg_m=second.home_deg_m)}
    page = preflight(field.fleet, settings, wait=False)
    found = page.vehicles[0].of("pad")
    assert [(each.level, each.text) for each in found] == [
        ("red", "stands 20 m from its planned pad, at most 15.0 m")
    ]
