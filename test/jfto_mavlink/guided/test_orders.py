"""Orders to a simulated fleet that is streamed to, in sped-up time."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from jfto.flight.fleet_link import open_fleet
from jfto_mavlink.errors import FlightError, MissionError
from jfto_mavlink.fleet.fly import Fleet
from jfto_mavlink.fleet.orders import OrderSettings
from jfto_mavlink.guided.orders import GuidedOrders
from jfto_mavlink.guided.reference import reference
from jfto_mavlink.guided.scheduler import GuidedSettings
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_world.terrain.frame import LocalFrame

SPEEDUP = 10.0
EPOCH_NS = 1_763_776_800 * 10**9
# A busy computer stalls for tenths of a second, which are seconds of sped-up time.
PATIENT = GuidedSettings(source_silent_max_s=6.0, position_silent_max_s=6.0, stalled_max_s=6.0)


def wait(condition, limit_s: float = 30.0) -> bool:
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
    """Two simulated vehicles, orders to them, and a source of trajectories that can fall silent."""

    def __init__(self, plan, link, *, may_arm: bool = True) -> None:
        self.plan, self.link = plan, link
        self.missions = {m.uav: m for m in build_missions(plan, MissionSettings())}
        self.orders = GuidedOrders(
            Fleet(link, self.missions), OrderSettings(may_arm), plan, self.now_ns, PATIENT
        )
        self.alive = True

    def now_ns(self) -> int:
        return EPOCH_NS + round(self.link.clock() * 1e9)

    def publish(self, delay_s: float) -> None:
        """Trajectories whose lift-off is a while ahead."""
        for uav in self.plan.uavs:
            start_ns = self.now_ns() + round(delay_s * 1e9)
            self.orders.take(uav.id, away(uav.start_m, start_ns))

    def wait(self, condition) -> bool:
        """Wait while the source lives."""

        def look() -> bool:
            if self.alive:
                for uav in self.missions:
                    self.orders.confirm(uav)
            return condition()

        return wait(look)

    def error_m(self, uav: str) -> float:
        """Distance of a vehicle, as reported, from its trajectory."""
        mission, vehicle = self.missions[uav], self.link.vehicle(uav)
        here = LocalFrame(self.plan.origin).to_enu(
            vehicle.lat_deg, vehicle.lon_deg, mission.home_deg_m[2] + vehicle.height_m
        )
        late_s = self.link.clock() - (vehicle.position_s or 0.0)
        at_ns = np.array([self.now_ns() - round(late_s * 1e9)])
        wanted = reference(self.orders._trajectories[uav], at_ns).position_m[0]
        return float(np.linalg.norm(here - wanted))

    def modes(self) -> set[str]:
        return {self.link.vehicle(uav).mode_name for uav in self.missions}


@pytest.fixture
def field(plan):
    with open_fleet(["sim:2"], plan, speedup=SPEEDUP) as link:
        yield Field(plan, link)


def test_a_fleet_is_streamed_to_held_and_let_go_on(field):
    """Start, on the trajectory, pause, resume, source lost, abort: each seen to work."""
    with pytest.raises(FlightError, match="no trajectory has come"):
        field.orders.start()
    # Ready to arm after 40 s; the gate waits for it.
    field.publish(90.0)
    assert field.orders.start() == "streaming: uav1, uav2"
    assert field.modes() == {"GUIDED"}
    begun_ns = field.orders._trajectories["uav1"].start_ns
    assert field.wait(lambda: field.now_ns() > begun_ns + 28 * 10**9)
    assert field.error_m("uav1") < 3.0
    assert field.error_m("uav2") < 3.0
    assert field.orders.streaming("uav1") == "streaming"
    assert field.orders.pause() == "holding: uav1, uav2"
    assert field.modes() == {"BRAKE"}
    assert field.orders.streaming("uav1") == "paused by the operator"
    assert field.orders.resume() == "streaming: uav1, uav2"
    assert field.wait(lambda: field.error_m("uav1") < 3.0 and field.error_m("uav2") < 3.0)
    field.alive = False
    assert wait(lambda: field.modes() == {"BRAKE"})
    assert "silent" in field.orders.streaming("uav1")
    field.alive = True
    field.orders.resume()
    assert field.wait(lambda: field.error_m("uav1") < 3.0 and field.error_m("uav2") < 3.0)
    assert field.orders.abort() == "uav1 returning, uav2 returning"
    assert wait(lambda: field.orders.streaming("uav1") != "streaming")
    assert field.orders.streaming("uav1") in ("aborted by the operator", "it is RTL")
    # No BRAKE of the stream's comes after it.
    until_s = field.link.clock() + 6.0
    assert wait(lambda: field.link.clock() > until_s)
    assert field.modes() == {"RTL"}
    field.orders.close()


def test_what_cannot_be_flown_is_not_started(field):
    """Too fast, or gone long ago: named, nobody armed."""
    pad = field.plan.uavs[0].start_m
    with pytest.raises(MissionError, match="uav1: its trajectory asks for"):
        field.orders.take("uav1", away(pad, field.now_ns(), 20.0))
    field.publish(-300.0)
    with pytest.raises(FlightError, match=r"has gone on and is 15\d m away"):
        field.orders.start()
    assert not field.link.vehicle("uav1").armed
