"""The gate with vehicles behind it: what would have hurt in the field is refused beforehand."""

from __future__ import annotations

from dataclasses import replace

import pytest

from jfto_mavlink.dialect import MODES
from jfto_mavlink.errors import FlightError, RosterError, SigningError
from jfto_mavlink.fleet.fly import Fleet, deliver_to_fleet, preflight
from jfto_mavlink.fleet.orders import FleetOrders, OrderSettings
from jfto_mavlink.io.signing import Signer
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.changed import ChangedParameters
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.preflight.page import AMBER, GREEN, RED
from jfto_mavlink.preflight.settings import GateSettings
from jfto_mavlink.protocol.item import MISSION
from jfto_msgs_py.records.battery import Battery
from jfto_sim import LinkFaults, Vehicle, VehicleConfig
from jfto_world.motion.battery import Drain
from support.rehearsal import CLEAN, Rehearsal

READY_S = 45.0
NEVER = GateSettings(wait_s=2.0)
FENCED = {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 1.0, "FENCE_ALT_MAX": 35.0}


class Ground:
    """The two vehicles of the plan on their pads, switched on and ready; `changes` by UAV."""

    def __init__(self, plan, changed=None, gate=NEVER, **changes) -> None:
        built = build_missions(plan, MissionSettings())
        self.missions = {mission.uav: mission for mission in built}
        vehicles = {}
        for number, (uav, mission) in enumerate(self.missions.items(), 1):
            lat, lon, alt = mission.home_deg_m
            config = VehicleConfig(number, lat, lon, alt, utc_at_boot_us=1_800_000_000_000_000)
            vehicles[uav] = Vehicle(replace(config, **changes.get(uav, {})))
        self.runner = Rehearsal(vehicles, step_s=0.02)
        self.pages = []
        self.fleet = Fleet(
            self.runner, self.missions, None, changed or ChangedParameters(), self.pages.append
        )
        self.orders = FleetOrders(self.fleet, OrderSettings(may_arm=True, gate=gate))
        self.runner.advance(READY_S)

    def refused(self, order: str = "upload") -> str:
        """Why an order is refused; nothing is on board and nobody is armed."""
        with pytest.raises(FlightError) as caught:
            getattr(self.orders, order)()
        assert caught.value.code == 601
        vehicles = self.runner.air.vehicles.values()
        assert order != "upload" or all(v.store.count(MISSION) == 0 for v in vehicles)
        assert not any(vehicle.flight.motors.armed for vehicle in vehicles)
        return str(caught.value)


def test_a_mission_that_breaks_a_vehicles_fence_is_not_uploaded(plan):
    """FIELD 4: all four breached at 100 m and went home; now it is said with the cure."""
    text = Ground(plan, uav2={"parameters": FENCED}).refused()
    assert "Nothing is uploaded. uav2: the mission breaks its fence: it climbs to" in text
    assert "Raise FENCE_ALT_MAX above" in text
    assert "uav1:" not in text


def test_vehicles_on_each_others_pads_are_not_uploaded_to(plan):
    """FIELD 5: swapped, 20 m apart here; each is told whose pad it stands on."""
    homes = [mission.home_deg_m for mission in build_missions(plan, MissionSettings())]
    names = ("home_lat_deg", "home_lon_deg", "home_alt_m")
    first, second = (dict(zip(names, home, strict=True)) for home in homes)
    text = Ground(plan, uav1=second, uav2=first).refused()
    assert "uav1: stands 20.0 m from its planned pad and 0.0 m from that of uav2" in text
    assert "uav2: stands 20.0 m from its planned pad and 0.0 m from that of uav1" in text


def test_vehicles_300_m_above_their_pads_are_not_uploaded_to(plan):
    """FIELD 18: only the horizontal distance was compared."""
    high = {"home_alt_m": 788.0}
    text = Ground(plan, uav1=high, uav2=high).refused()
    assert "uav1: stands +300 m above its planned pad" in text


def test_two_vehicles_under_one_system_id_are_found_before_anything_is_sent(plan):
    """FIELD 6: it came out after others were armed; neither of the two is written to."""
    ground = Ground(plan)
    air = ground.runner.air
    lat, lon, alt = ground.missions["uav1"].home_deg_m
    air.vehicles[101] = Vehicle(VehicleConfig(1, lat, lon, alt, uid2=tuple(range(1, 19))))
    air.up[101], air.down[101] = (type(air.up[1])(CLEAN, seed) for seed in (1, 2))
    ground.runner.advance(2.5)
    text = ground.refused()
    assert "uav1: two vehicles answer to system id 1" in text
    assert "SYSID_THISMAV" in text


def test_wind_is_spoken_of_before_the_start(plan):
    """FIELD 7: nobody said a word. A copter on the ground cannot tell; the plan's limit is said."""
    windy = {"wind_mps": (8.0, 0.0)}
    ground = Ground(plan, gate=replace(NEVER, wind_max_mps=3.0), uav1=windy)
    page = preflight(ground.fleet, ground.orders.settings.gate)
    (found,) = page.vehicles[0].of("wind")
    assert found.level == AMBER
    assert "cannot tell the wind; the plan allows for 3 m/s" in found.text
    assert found.cure == "Measure it by hand."


def test_a_charge_that_does_not_last_for_the_way_home_stops_the_start(plan):
    """FIELD 11: by what hovering takes and what the battery holds; before arming."""
    hovers = Drain(Battery(0.0, 300.0, 300.0), speed_mps=8.0)
    gate = replace(NEVER, drains=dict.fromkeys(("uav1", "uav2"), hovers))
    ground = Ground(plan, gate=gate)
    ground.orders.upload()
    battery = ground.runner.vehicles["uav2"].battery
    battery.consumed_mah = 0.6 * ground.runner.vehicles["uav2"].params["BATT_CAPACITY"]
    ground.runner.advance(3.0)
    text = ground.refused("start")
    assert "uav2: 40 % left; needs" in text
    assert "uav1:" not in text


def test_what_is_right_is_on_the_page_too(plan):
    """The page is made each time, with every topic for every vehicle; nothing is changed."""
    ground = Ground(plan)
    page = preflight(ground.fleet, NEVER)
    assert page == ground.pages[-1]
    assert page.stops() == ()
    for vehicle in page.vehicles:
        topics = {finding.topic for finding in vehicle.findings}
        assert topics >= {"identity", "pad", "fence", "home", "battery", "failsafe", "parameters"}
        assert vehicle.of("fence")[0].level == GREEN
        assert [str(change) for change in vehicle.changes] == ["WPNAV_RADIUS 200 → 120"]
    assert ground.runner.vehicles["uav1"].params["WPNAV_RADIUS"] == 200.0


def test_the_page_is_right_over_a_bad_link(plan):
    """A third of all frames lost each way: the same findings, only later."""
    ground = Ground(plan)
    loss = LinkFaults(loss=0.3)
    for number in (1, 2):
        ground.runner.air.set_faults(number, loss, loss)
    page = preflight(ground.fleet, replace(NEVER, silent_max_s=10.0))
    assert page.stops() == ()
    assert page.vehicles[0].of("fence")[0].text == "its fence is off"


def test_parameters_change_at_the_start_and_are_as_before_after_an_abort(plan, tmp_path):
    """FIELD 10: what they were is on disk while they are changed, and found by the next program."""
    path = tmp_path / "parameters.json"
    ground = Ground(plan, ChangedParameters(path))
    params = {uav: vehicle.params for uav, vehicle in ground.runner.vehicles.items()}
    ground.orders.upload()
    assert {each["WPNAV_RADIUS"] for each in params.values()} == {200.0}
    assert not path.exists()
    ground.orders.start()
    assert {each["WPNAV_RADIUS"] for each in params.values()} == {120.0}
    assert ChangedParameters(path).vehicles["uav1"].values == {"WPNAV_RADIUS": 200.0}
    ground.orders.restore()
    assert path.exists(), "nothing is put back in flight"
    ground.orders.abort()
    states = [ground.runner.station.vehicle(uav) for uav in params]
    assert ground.runner.until(lambda: not any(state.armed for state in states), 200.0)
    # Another run of the program, after this one was killed.
    again = FleetOrders(
        replace(ground.fleet, changed=ChangedParameters(path)), OrderSettings(may_arm=False)
    )
    assert again.restore() == "Parameters are as before the flight: uav1, uav2."
    assert {each["WPNAV_RADIUS"] for each in params.values()} == {200.0}
    assert not path.exists()


def test_a_start_that_fails_leaves_no_parameter_changed(plan, tmp_path):
    """One does not arm: all disarm, and have theirs back at once."""
    path = tmp_path / "parameters.json"
    ground = Ground(plan, ChangedParameters(path))
    ground.orders.upload()
    ground.runner.vehicles["uav2"].arming.arm = lambda *_args, **_kwargs: 4
    with pytest.raises(FlightError, match="held back, because uav2"):
        ground.orders.start()
    params = [vehicle.params["WPNAV_RADIUS"] for vehicle in ground.runner.vehicles.values()]
    assert params == [200.0, 200.0]
    assert not path.exists()
    modes = {ground.runner.station.vehicle(uav).mode for uav in ground.missions}
    assert MODES["AUTO"] not in modes


def test_another_airframe_is_not_given_the_parameters_of_the_first(plan, tmp_path):
    """The record names the uid; what it says stays until that vehicle is back."""
    ground = Ground(plan)
    changed = ChangedParameters(tmp_path / "parameters.json")
    changed.note("uav1", "another", {"WPNAV_RADIUS": 300.0})
    orders = FleetOrders(replace(ground.fleet, changed=changed), OrderSettings(may_arm=False))
    with pytest.raises(FlightError, match="uav1: is another vehicle"):
        orders.restore()
    assert ground.runner.vehicles["uav1"].params["WPNAV_RADIUS"] == 200.0
    assert "uav1" in changed.vehicles


KEYS = (bytes(range(32)), bytes(range(1, 33)))


@pytest.mark.parametrize(
    ("vehicles_key", "ours", "words"),
    [
        (KEYS[0], None, "signs its frames and answers none that are unsigned"),
        (KEYS[0], KEYS[1], "signs with another key"),
        (b"", KEYS[0], "does not sign its frames"),
    ],
)
def test_signatures_that_do_not_fit_are_not_silence(plan, vehicles_key, ours, words):
    """FIELD 12: heartbeats arrive, so it is error 702 with the cure, and said at once."""
    built = build_missions(plan, MissionSettings())[0]
    vehicle = Vehicle(VehicleConfig())
    vehicle.key.secret = vehicles_key
    unix_s = VehicleConfig().utc_at_boot_us / 1e6
    signer = None if ours is None else Signer(ours, lambda: unix_s)
    runner = Rehearsal({"uav1": vehicle}, port=1, signer=signer)
    runner.advance(10.0)
    error = deliver_to_fleet(runner, {"uav1": built.mission}).failed["uav1"]
    assert isinstance(error, SigningError)
    assert (error.code, words in str(error)) == (702, True)
    page = preflight(Fleet(runner, {"uav1": built}), NEVER)
    (finding,) = page.vehicles[0].findings
    assert (finding.level, words in finding.text) == (RED, True)


def test_a_fleet_that_fits_is_in_no_conflict(plan):
    """The same checks let a good fleet through."""
    ground = Ground(plan)
    assert "2 missions on board" in ground.orders.upload()
    for uav in ground.missions:
        ground.runner.station.check_identity(uav)
    assert not issubclass(SigningError, RosterError)
