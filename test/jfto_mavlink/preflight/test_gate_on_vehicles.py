"""The gate over real links: the same on `jfto_sim` and on ArduCopter (JFTO_ARDUCOPTER)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import pytest

from jfto_mavlink.errors import FlightError, RosterError
from jfto_mavlink.fleet.fly import Fleet, preflight
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.orders import FleetOrders, OrderSettings
from jfto_mavlink.fleet.roster import parse_vehicles
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.changed import ChangedParameters
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.preflight.page import AMBER, GREEN, RED
from jfto_mavlink.preflight.settings import GateSettings
from jfto_mavlink.protocol.exchange import Context, Exchange, wait_for
from jfto_mavlink.protocol.parameter import read_parameters, set_parameter
from jfto_mavlink.protocol.timesync import ScaledClock
from jfto_sim import VehicleConfig
from support.vehicles import SPEEDUP, Starter, Vehicles

pytestmark = pytest.mark.slow
# Of the vehicles' time: ArduCopter is ready some 43 s after power-up, and here no silence of a
# busy computer is taken for the vehicle's.
PATIENT = GateSettings(wait_s=240.0, silent_max_s=60.0)
FENCED = {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 1.0, "FENCE_ALT_MAX": 35.0}


class Ground:
    """A fleet over its links, with the orders of the bridge."""

    def __init__(self, link: FleetLink, missions, changed: ChangedParameters) -> None:
        self.link, self.changed = link, changed
        self.fleet = Fleet(link, missions, None, changed)
        self.orders = FleetOrders(self.fleet, OrderSettings(may_arm=True, gate=PATIENT))

    def look(self, gate: GateSettings = PATIENT):
        """The page."""
        return preflight(self.fleet, gate)

    def looked_and_uploaded(self) -> str:
        """What an upload after a look comes to."""
        self.look()
        return self.orders.upload()

    def refused(self) -> str:
        """Why an upload is refused, once all know where they stand."""
        self.look()
        with pytest.raises(FlightError) as caught:
            self.orders.upload()
        assert caught.value.code == 601
        assert not any(self.link.vehicle(uav).armed for uav in self.fleet.missions)
        return str(caught.value)

    def set_gps(self, *, on: bool) -> None:
        """Let all receivers fail or work again, and see the fix change."""

        def switch(context: Context) -> Exchange[bool]:
            yield from set_parameter(context, "SIM_GPS_DISABLE", 0.0 if on else 1.0)
            return (yield from wait_for(context, lambda: has_fix(context) == on, 60.0))

        def has_fix(context: Context) -> bool:
            return (context.vehicle.gps_fix or 0) >= 3

        assert self.fleet.run(switch) == dict.fromkeys(self.fleet.missions, True)

    def parameter(self, name: str) -> dict[str, float]:
        """A parameter of each vehicle."""

        def ask(context: Context) -> Exchange[dict[str, float]]:
            return (yield from read_parameters(context, (name,)))

        return {uav: found[name] for uav, found in self.fleet.run(ask).items()}


def on_pads(plan) -> list[VehicleConfig]:
    """The two vehicles of the plan where they belong."""
    homes = [mission.home_deg_m for mission in build_missions(plan, MissionSettings())]
    return [
        VehicleConfig(sysid=n, home_lat_deg=lat, home_lon_deg=lon, home_alt_m=alt)
        for n, (lat, lon, alt) in enumerate(homes, 1)
    ]


@contextmanager
def ground_of(
    plan, started: Vehicles, changed: ChangedParameters | None = None
) -> Iterator[Ground]:
    """Links to them, all heard."""
    missions = {one.uav: one for one in build_missions(plan, MissionSettings())}
    roster = parse_vehicles(tuple(started.links), tuple(missions))
    assert roster is not None
    with FleetLink(roster, clock=ScaledClock(SPEEDUP)) as link:
        link.wait_heard(60.0 * SPEEDUP)
        yield Ground(link, missions, changed or ChangedParameters())


def test_what_is_not_ready_yet_is_waited_for(plan, vehicles: Starter):
    """Without GPS: amber for who only looks. With it again: green after the wait, on their pads."""
    with ground_of(plan, vehicles(on_pads(plan))) as ground:
        ground.look()
        ground.set_gps(on=False)
        early = ground.look(replace(PATIENT, wait_s=0.0, waited_for=True))
        assert early.counts()["waits"] >= 2
        assert early.level == AMBER
        ground.set_gps(on=True)
        page = ground.look()
        assert page.stops() == ()
        for vehicle in page.vehicles:
            levels = {topic: vehicle.of(topic)[0].level for topic in ("position", "pad", "fence")}
            assert levels == dict.fromkeys(levels, GREEN)


def test_a_mission_above_a_vehicles_fence_is_not_uploaded(plan, vehicles: Starter):
    """FIELD 4: said of the vehicle whose fence it is, with the cure."""
    first, second = on_pads(plan)
    started = vehicles([first, replace(second, parameters=FENCED)])
    with ground_of(plan, started) as ground:
        text = ground.refused()
    assert "uav2: the mission breaks its fence: it climbs to" in text
    assert "Raise FENCE_ALT_MAX above" in text
    assert "uav1:" not in text


def test_vehicles_on_each_others_pads_are_not_uploaded_to(plan, vehicles: Starter):
    """FIELD 5: 20 m apart, each told whose pad it stands on."""
    first, second = on_pads(plan)
    started = vehicles([replace(second, sysid=1), replace(first, sysid=2)])
    with ground_of(plan, started) as ground:
        text = ground.refused()
    assert "m from that of uav2" in text
    assert "m from that of uav1" in text


def test_vehicles_high_above_their_pads_are_not_uploaded_to(plan, vehicles: Starter):
    """FIELD 18: 300 m."""
    configs = [replace(c, home_alt_m=c.home_alt_m + 300.0) for c in on_pads(plan)]
    with ground_of(plan, vehicles(configs)) as ground:
        text = ground.refused()
    assert "m above its planned pad" in text


def test_two_vehicles_under_one_system_id_are_found_out(plan, vehicles: Starter):
    """FIELD 6: on one link, before anything is sent: both are refused by their common id."""
    first, second = on_pads(plan)
    double = replace(first, uid2=tuple(range(1, 19)))
    started = vehicles([first, second, double], shared=True)
    with (
        pytest.raises((RosterError, FlightError), match="two vehicles answer to system id 1 "),
        ground_of(plan, started) as ground,
    ):
        # Where the second is heard only after the links are up, the upload is refused.
        ground.looked_and_uploaded()


def test_what_the_autopilot_misses_is_said_in_its_own_words(plan, vehicles: Starter):
    """A battery below BATT_ARM_VOLT passes by no waiting: red, verbatim, and no start."""
    first, second = on_pads(plan)
    weak = replace(second, parameters={"BATT_ARM_VOLT": 20.0})
    with ground_of(plan, vehicles([first, weak])) as ground:
        page = ground.look(replace(PATIENT, wait_s=90.0, waited_for=True))
        stops = page.stops()
        assert len(stops) == 1
        assert stops[0].startswith("uav2: ")
        assert "Battery 1 below minimum arming voltage" in stops[0]
        assert page.vehicles[1].of("autopilot")[0].level == RED


def test_parameters_are_as_before_after_a_start_and_an_abort(plan, vehicles: Starter, tmp_path):
    """FIELD 10: changed at the start only, and put back once both are down."""
    changed = ChangedParameters(tmp_path / "parameters.json")
    with ground_of(plan, vehicles(on_pads(plan)), changed) as ground:
        before = ground.parameter("WPNAV_RADIUS")
        ground.look()
        ground.orders.upload()
        assert ground.parameter("WPNAV_RADIUS") == before
        ground.orders.start()
        assert set(ground.parameter("WPNAV_RADIUS").values()) == {120.0}
        ground.orders.abort()
        until_s = ground.link.clock() + 300.0
        while any(ground.link.vehicle(uav).armed for uav in ground.fleet.missions):
            assert ground.link.clock() < until_s
            ground.look(replace(PATIENT, wait_s=0.0))
        ground.orders.restore()
        assert ground.parameter("WPNAV_RADIUS") == before
    assert not (tmp_path / "parameters.json").exists()
