"""Orders to a simulated fleet that is streamed to, in sped-up time."""

from __future__ import annotations

import json
import threading
import time

import numpy as np
import pytest

from jfto.flight.fleet_link import Simulated, open_fleet
from jfto_mavlink.errors import FlightError, MissionError
from jfto_mavlink.fleet.fly import Fleet
from jfto_mavlink.fleet.orders import OrderSettings
from jfto_mavlink.guided.orders import GuidedOrders
from jfto_mavlink.guided.reference import reference
from jfto_mavlink.guided.scheduler import GuidedSettings
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_msgs_py.records.event import ERROR, Event
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_world.terrain.frame import LocalFrame

SPEEDUP = 5.0
EPOCH_NS = 1_763_776_800 * 10**9
# A busy computer stalls for tenths of a second, which are seconds of sped-up time.
PATIENT = GuidedSettings(stalled_s=20.0, astray_max_m=80.0)


def wait(condition, limit_s: float = 120.0) -> bool:
    """Wait until a condition holds."""
    until = time.monotonic() + limit_s
    pause = threading.Event()
    while not condition():
        if time.monotonic() > until:
            return False
        pause.wait(0.02)
    return True


def away(pad_m, start_ns: int, seconds: float = 60.0) -> TimedTrajectory:
    """From the pad 150 m east and 20 m up, at rest at both ends."""
    times = np.arange(0.0, seconds + 0.1, 0.5)
    u = times / seconds
    way = np.array([150.0, 0.0, 20.0])
    share = u**3 * (10 - 15 * u + 6 * u**2)
    rate = 30 * u**2 * (1 - u) ** 2 / seconds
    bend = 60 * u * (1 - u) * (1 - 2 * u) / seconds**2
    return TimedTrajectory(
        start_ns,
        np.rint(times * 1e9).astype(np.int64),
        np.array(pad_m) + share[:, None] * way,
        rate[:, None] * way,
        bend[:, None] * way,
    )


class Field:
    """Two simulated vehicles, orders to them, and trajectories that come once."""

    def __init__(self, plan, link, state_file) -> None:
        self.plan, self.link, self.state_file = plan, link, state_file
        self.missions = {m.uav: m for m in build_missions(plan, MissionSettings())}
        self.told: list[Event] = []
        self.orders = self.bridge()

    def bridge(self) -> GuidedOrders:
        """Orders of a bridge that begins now."""
        return GuidedOrders(
            Fleet(self.link, self.missions), OrderSettings(may_arm=True), self.plan, self.now_ns,
            PATIENT, self.state_file, self.told.append,
        )  # fmt: skip

    def now_ns(self) -> int:
        return EPOCH_NS + round(self.link.clock() * 1e9)

    def publish(self, delay_s: float = 3600.0, seconds: float = 60.0) -> None:
        """Trajectories whose lift-off is a while ahead."""
        start_ns = self.now_ns() + round(delay_s * 1e9)
        for uav in self.plan.uavs:
            self.orders.take(uav.id, away(uav.start_m, start_ns, seconds))

    def fly(self) -> None:
        """Into the air and onto the curves."""
        self.publish()
        self.orders.upload()
        assert self.orders.start() == "streaming: uav1, uav2"
        assert self.modes() == {"GUIDED"}

    def along_s(self) -> float:
        progressed = self.orders.progressed()
        return -1.0 if progressed is None else progressed.elapsed_s

    def error_m(self, uav: str) -> float:
        """Distance of a vehicle, as reported, from its trajectory."""
        mission, vehicle = self.missions[uav], self.link.vehicle(uav)
        here = LocalFrame(self.plan.origin).to_enu(
            vehicle.lat_deg, vehicle.lon_deg, mission.home_deg_m[2] + vehicle.height_m
        )
        late_s = self.link.clock() - (vehicle.position_s or 0.0)
        curve = self.orders._flight.curve(uav)
        at_ns = np.array([curve.start_ns + round((self.along_s() - late_s) * 1e9)])
        return float(np.linalg.norm(here - reference(curve, at_ns).position_m[0]))

    def on_track(self) -> bool:
        return max(self.error_m("uav1"), self.error_m("uav2")) < 3.0

    def modes(self) -> set[str]:
        return {self.link.vehicle(uav).mode_name for uav in self.missions}


@pytest.fixture
def field(plan, tmp_path):
    with open_fleet(["sim:2"], plan, simulated=Simulated(SPEEDUP)) as link:
        yield Field(plan, link, tmp_path / "flight_state.json")


@pytest.mark.slow(15)
def test_a_fleet_is_streamed_to_held_let_go_on_and_called_home(field):
    """The curves that came once are flown though nothing comes any more; each order is obeyed."""
    with pytest.raises(FlightError, match="no trajectory has come"):
        field.orders.start()
    field.fly()
    # Not at the very moment: a stall of the computer is made up for first.
    assert wait(lambda: field.along_s() > 28.0 and field.on_track())
    assert field.orders.streaming("uav1") == "streaming"
    assert field.orders.pause() == "holding: uav1, uav2"
    assert field.modes() == {"BRAKE"}
    assert field.orders.streaming("uav1") == "paused by the operator"
    stood_s, until_s = field.orders._paused_s, field.link.clock() + 10.0
    assert wait(lambda: field.link.clock() > until_s)
    assert field.orders.resume() == "streaming: uav1, uav2"
    # They go on from where they stand, not where they would have been.
    assert field.along_s() < stood_s + 5.0
    assert wait(field.on_track)
    assert any(event.kind == "late" for event in field.told)
    assert field.orders.abort() == "uav1 returning, uav2 returning"
    assert wait(lambda: field.orders.streaming("uav1") != "streaming")
    # No BRAKE of the stream's comes after it.
    until_s = field.link.clock() + 6.0
    assert wait(lambda: field.link.clock() > until_s)
    assert field.modes() == {"RTL"}
    field.orders.close()


@pytest.mark.slow(15)
def test_a_flight_ends_as_missions_do(field):
    """At the end of the curves all fly home by the missions on board, and land."""
    field.fly()
    assert wait(lambda: field.modes() == {"AUTO"})
    assert field.along_s() > 60.0
    assert wait(lambda: not any(field.link.vehicle(uav).armed for uav in field.missions))
    assert not field.told


@pytest.mark.slow(15)
def test_newer_trajectories_replace_those_held(field):
    """All at once, and only where each is near: a fleet that mixed plannings is not certified."""
    field.fly()
    assert wait(lambda: field.along_s() > 20.0)
    zero_ns = field.orders.progressed().zero_ns
    first, second = field.plan.uavs
    field.orders.take(first.id, away(first.start_m, zero_ns, 70.0))
    before_s = field.link.clock()
    assert wait(lambda: field.link.clock() > before_s + 2.0)
    assert field.orders._flight.curves.end_s == 60.0
    field.orders.take(second.id, away(second.start_m, zero_ns, 70.0))
    assert wait(lambda: field.orders._flight.curves.end_s == 70.0)
    far = np.array(second.start_m) + np.array([0.0, 300.0, 0.0])
    for uav in (first, second):
        place = far if uav is second else uav.start_m
        field.orders.take(uav.id, away(place, zero_ns, 65.0))
    assert wait(lambda: any("too far away (uav2" in event.text for event in field.told))
    assert field.orders._flight.curves.end_s == 70.0
    assert wait(field.on_track)
    field.orders.abort()


@pytest.mark.slow(15)
def test_a_bridge_that_died_is_followed_by_one_that_goes_on(field):
    """It knows the curves and how far they were flown from disk, and all go on together."""
    field.fly()
    assert wait(lambda: field.along_s() > 25.0)
    died = field.orders
    # Killed: it sends nothing any more, and does nothing else either.
    for scheduler in died._schedulers.values():
        scheduler.leave("killed")
    kept = field.state_file.with_name("guided_flight.json")
    assert wait(lambda: json.loads(kept.read_text())["over"])
    kept.write_text(
        json.dumps(
            {"format": "jfto-guided-flight", "version": 1, "zero_ns": died.progressed().zero_ns,
             "at_ns": field.now_ns(), "elapsed_s": field.along_s(), "paused": False, "over": False}
        )
    )  # fmt: skip
    until_s = field.link.clock() + 12.0
    assert wait(lambda: field.link.clock() > until_s)
    field.orders = field.bridge()
    field.orders.pick_up()
    assert field.orders.streaming("uav2") == "streaming"
    (late,) = [event.text for event in field.told if event.kind == "late"]
    assert "the fleet goes on" in late
    assert wait(field.on_track)
    assert wait(lambda: field.modes() == {"AUTO"})


@pytest.mark.slow(15)
def test_a_bridge_that_knows_nothing_of_a_flight_calls_it_home(field):
    """Vehicles that hover in GUIDED are not left to themselves, and everybody is told."""
    field.fly()
    assert wait(lambda: field.along_s() > 20.0)
    for scheduler in field.orders._schedulers.values():
        scheduler.leave("killed")
    kept = field.state_file.with_name("guided_flight.json")
    assert wait(lambda: json.loads(kept.read_text())["over"])
    kept.unlink()
    field.orders = field.bridge()
    field.orders.pick_up()
    assert field.modes() == {"RTL"}
    assert any(event.level == ERROR and "called home" in event.text for event in field.told)


def test_what_cannot_be_flown_is_not_started(field):
    """Too fast, or from somewhere else: named, nobody armed."""
    pad = field.plan.uavs[0].start_m
    with pytest.raises(MissionError, match="uav1: its trajectory asks for"):
        field.orders.take("uav1", away(pad, field.now_ns(), 20.0))
    start_ns = field.now_ns()
    for uav in field.plan.uavs:
        field.orders.take(uav.id, away(np.array(uav.start_m) + np.array([100.0, 0, 0]), start_ns))
    with pytest.raises(FlightError, match=r"its trajectory begins 100 m away"):
        field.orders.start()
    assert not field.link.vehicle("uav1").armed
