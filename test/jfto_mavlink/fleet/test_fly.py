"""Whole flights of a small fleet in virtual time, good ones and bad ones."""

from __future__ import annotations

import dataclasses
from functools import partial

import numpy as np
import pytest

from jfto_mavlink.dialect import MODES, mavlink
from jfto_mavlink.errors import CommandError, FlightError, TransferError
from jfto_mavlink.fleet.fly import Fleet, FlySettings, deliver_to_fleet, preflight, start_fleet
from jfto_mavlink.fleet.monitor import FlightMonitor
from jfto_mavlink.fleet.orders import FleetOrders, OrderSettings
from jfto_mavlink.flight.control import (
    StartLine,
    brake,
    change_mission,
    land,
    pause,
    resume,
    return_home,
    start,
)
from jfto_mavlink.flight.follow import FlightTiming
from jfto_mavlink.flight.telemetry import LinkState, listen
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.deliver import deliver
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.preflight.gate import inspect
from jfto_mavlink.preflight.judge import judge
from jfto_mavlink.preflight.settings import GateSettings
from jfto_mavlink.protocol.command import send_command, set_mode
from jfto_mavlink.protocol.exchange import Wait
from jfto_msgs_py.records.event import WARN
from jfto_sim import LinkFaults, Vehicle, VehicleConfig
from support.rehearsal import CLEAN, Rehearsal

READY_S = 45.0


class Field:
    """A fleet on its pads, ready to arm, missions on board and released."""

    def __init__(self, plan, settings: MissionSettings | None = None, **extra) -> None:
        built = build_missions(plan, settings or MissionSettings())
        self.missions = {mission.uav: mission for mission in built}
        vehicles = {
            uav: Vehicle(
                VehicleConfig(
                    sysid=n,
                    home_lat_deg=mission.home_deg_m[0],
                    home_lon_deg=mission.home_deg_m[1],
                    home_alt_m=mission.home_deg_m[2],
                )
            )
            for n, (uav, mission) in enumerate(self.missions.items(), 1)
        }
        self.events = []
        self.said = []
        self.runner = Rehearsal(vehicles, step_s=0.02, **extra)
        self.timings = {}
        self.monitor = FlightMonitor(self.missions)
        for uav, mission in self.missions.items():
            self.runner.start(uav, partial(listen, mission=mission, sink=self._take))
            self.runner.start(uav, self._time)
        self.runner.advance(READY_S)
        self.release = deliver_to_fleet(
            self.runner, {u: m.mission for u, m in self.missions.items()}
        ).release()

    @property
    def fleet(self) -> Fleet:
        return Fleet(self.runner, self.missions, self.report)

    def report(self, uav, step) -> None:
        self.said.append((self.runner.now_s, f"{uav} {step.text}"))

    def _take(self, sample) -> None:
        if isinstance(sample, LinkState):
            self.events += self.monitor.take(sample)

    def _time(self, context):
        timing = self.timings[context.uav] = FlightTiming(context, self.missions[context.uav])
        while True:
            message = yield Wait(context.clock() + 1.0)
            if message is not None:
                timing.take(message)

    def start(self, settings: FlySettings | None = None) -> None:
        start_fleet(self.fleet, self.release, settings or FlySettings())

    def fly(self, settings: FlySettings | None = None):
        """Start, wait until all are down; returns how each passed its waypoints."""
        self.start(settings)
        vehicles = [self.runner.station.vehicle(uav) for uav in self.missions]
        assert self.runner.until(lambda: not any(each.armed for each in vehicles), 400.0)
        return {uav: timing.passed for uav, timing in self.timings.items()}

    def missed(self, uav: str, within_m: float) -> list[int]:
        """Ids of waypoints not reached, or passed farther away than allowed."""
        near = {p.waypoint_id for p in self.timings[uav].passed if p.closest_m <= within_m}
        return [number for number in self.missions[uav].waypoint_ids if number not in near]

    def landed(self, uav: str) -> bool:
        return any((e.kind, e.uav_id) == ("landed", uav) for e in self.events)

    def take_off(self, uav: str = "uav1") -> None:
        """One vehicle in the air on its mission."""
        line = StartLine({uav: self.runner.now_s + 5.0})
        self.runner.start(uav, lambda context: start(context, line), self.report)
        vehicle = self.runner.station.vehicle(uav)
        assert self.runner.until(lambda: vehicle.height_m > 5.0, 60.0)

    def until_down(self, uav: str = "uav1", limit_s: float = 400.0) -> bool:
        vehicle = self.runner.station.vehicle(uav)
        return self.runner.until(lambda: not vehicle.armed, limit_s)

    def do(self, uav, job):
        """Result of one conversation; its error is raised."""
        result = self.runner.run({uav: job}, self.report)[uav]
        if isinstance(result, Exception):
            raise result
        return result


@pytest.mark.slow
@pytest.mark.parametrize("style", ["fly_through", "hold"])
def test_a_fleet_flies_its_plan_to_the_end(plan, style):
    """Every waypoint within 2 m, then home, landed, disarmed."""
    field = Field(plan, MissionSettings(style=style))
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
    field = Field(plan, to_vehicle=loss, from_vehicle=loss, seed=2)
    for uav in field.fly():
        assert field.landed(uav)
        assert field.missed(uav, 2.5) == []


@pytest.mark.slow
def test_time_gates_hold_the_fleet_to_the_clock(plan):
    """Flown once for true times, then gated: each vehicle leaves its gate at the planned second."""
    first = Field(plan)
    records = first.fly()
    routes = tuple(
        dataclasses.replace(route, arrival_s=tuple(p.reached_s for p in records[uav.id]))
        for uav, route in zip(plan.uavs, plan.routes, strict=True)
    )
    timed = dataclasses.replace(plan, routes=routes)
    lead_s = 30.0
    start_unix_s = VehicleConfig().utc_at_boot_us / 1e6 + READY_S + lead_s
    settings = MissionSettings(gates=(0,), start_unix_s=start_unix_s)
    field = Field(timed, settings)
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
        Field(plan).fly(FlySettings(start_at_s=READY_S + 1.0))


def test_an_order_to_start_waits_for_the_moment_of_the_gates(plan):
    """Lift-off at the second that the missions count from; an order too late arms nobody."""
    field = Field(plan)
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
    field = Field(plan)
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
    field = Field(plan)
    store = field.runner.vehicles["uav1"].store
    store.put(7, store.mission[11])
    with pytest.raises(FlightError, match="uav1: mission on board: item 7"):
        field.fly()
    assert not any(event.kind == "armed" for event in field.events)


def test_only_the_released_mission_is_flown(plan):
    """A mission built anew, with other settings, needs a release of its own."""
    field = Field(plan)
    built = build_missions(plan, MissionSettings(style="hold"))
    field.missions = {mission.uav: mission for mission in built}
    with pytest.raises(FlightError, match="not the released mission"):
        field.fly()


def test_a_vehicle_that_does_not_arm_holds_the_others_back(plan):
    """Arming fails for one: the other disarms again, both say why."""
    field = Field(plan)
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


@pytest.mark.slow
def test_pause_and_resume_reach_the_end(plan):
    """Paused it stands, resumed it goes on with the same waypoint."""
    field = Field(plan)
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
    field = Field(plan)
    with pytest.raises(FlightError, match="STABILIZE"):
        field.do("uav1", pause)


@pytest.mark.slow
@pytest.mark.parametrize(("job", "mode"), [(return_home, "RTL"), (land, "LAND"), (brake, "BRAKE")])
def test_aborts_are_seen_to_work(plan, job, mode):
    """Each ends in the mode it asks for, and that is told."""
    field = Field(plan)
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
    field = Field(plan)
    field.take_off()
    mission = field.missions["uav1"].mission
    with pytest.raises(TransferError, match="AUTO") as caught:
        field.do("uav1", lambda context: deliver(context, mission))
    assert caught.value.code == 405


@pytest.mark.slow
def test_a_changed_mission_in_flight_holds_first_and_starts_at_its_first_item(plan):
    """BRAKE, upload, read back, current item set, AUTO again."""
    field = Field(plan)
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
    field = Field(plan)
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
    field = Field(plan, MissionSettings(style="hold"))
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
    field = Field(plan)
    field.take_off()
    vehicle = field.runner.vehicles["uav1"]
    vehicle.battery.consumed_mah = 0.88 * vehicle.params["BATT_CAPACITY"]
    field.runner.advance(3.0)
    told = [event for event in field.events if (event.kind, event.level) == ("battery", WARN)]
    assert [event.text for event in told] == ["uav1 has 11 % of its battery left and flies on."]


def test_a_command_refused_carries_the_vehicles_reason(plan):
    """Arming in AUTO is refused by the autopilot, in its own words."""
    field = Field(plan)

    def arm_in_auto(context):
        yield from set_mode(context, MODES["AUTO"])
        yield from send_command(context, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, (1.0,))

    with pytest.raises(CommandError, match="AUTO mode not armable") as caught:
        field.do("uav1", arm_in_auto)
    assert caught.value.code == 503


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
    field = Field(plan)
    settings = GateSettings(wait_s=1.0)
    first, second = field.missions.values()
    field.missions = {"uav1": dataclasses.replace(first, home_deg_m=second.home_deg_m)}
    page = preflight(field.fleet, settings, wait=False)
    found = page.vehicles[0].of("pad")
    assert [(each.level, each.text) for each in found] == [
        ("red", "stands 20 m from its planned pad, at most 15.0 m")
    ]
