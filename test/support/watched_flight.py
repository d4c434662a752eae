"""Simulated flights in virtual time, and the bridge's book-keeping that listens to them."""

from __future__ import annotations

from functools import partial

from jfto_mavlink.fleet.changes import LOST_AFTER_S, Notice
from jfto_mavlink.fleet.fly import FlySettings, deliver_to_fleet, start_fleet
from jfto_mavlink.fleet.watched_flight import Found, WatchedFlight, recognise
from jfto_mavlink.flight.telemetry import LinkState, listen
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_sim import Vehicle, VehicleConfig
from support.rehearsal import Rehearsal

READY_S = 45.0
FAILSAFES = {"BATT_FS_LOW_ACT": 2.0, "BATT_LOW_VOLT": 11.0}


class Flight:
    """Simulated vehicles of a plan on their missions, and what an operator is told.

    Times are the vehicles' own UTC. `vehicles` are those of another flight that go on, `path` is
    where the book of the flight is.
    """

    def __init__(self, plan, path=None, vehicles=None) -> None:
        self.missions = {m.uav: m for m in build_missions(plan, MissionSettings())}
        self.vehicles = vehicles or {
            uav: Vehicle(
                VehicleConfig(
                    sysid=n,
                    home_lat_deg=mission.home_deg_m[0],
                    home_lon_deg=mission.home_deg_m[1],
                    home_alt_m=mission.home_deg_m[2],
                    parameters=FAILSAFES,
                )
            )
            for n, (uav, mission) in enumerate(self.missions.items(), 1)
        }
        self.runner = Rehearsal(self.vehicles, step_s=0.02)
        self.notices = []
        self.lift_offs = []
        self.keeper = WatchedFlight(
            self.missions,
            path,
            LOST_AFTER_S,
            lambda *told: self.notices.append(Notice(*told)),
            self.lift_offs.append,
            lambda moment: moment.utc_ns,
            lambda context, at_ns: context.vehicle.boot_s(at_ns),
        )
        self.keeper.begin()
        for uav, mission in self.missions.items():
            job = partial(listen, mission=mission, sink=self._take, under_way=self.keeper.under_way)
            self.runner.start(uav, job)

    @property
    def monitor(self):
        return self.keeper.monitor

    def _take(self, sample) -> None:
        if isinstance(sample, LinkState):
            self.keeper.take(sample)

    def start(self) -> None:
        """Upload, start, and wait for the fleet's lift-off."""
        self.runner.advance(READY_S)
        missions = {uav: mission.mission for uav, mission in self.missions.items()}
        release = deliver_to_fleet(self.runner, missions).release()
        start_fleet(self.runner, self.runner.clock, release, self.missions, FlySettings())
        self.until("lift_off", "", 10.0)

    def recognise(self) -> None:
        """What a bridge does first of all."""
        jobs = {
            u: partial(recognise, mission=m.mission, heard_wait_s=15.0)
            for u, m in self.missions.items()
        }
        for uav, vehicle in self.runner.run(jobs).items():
            self.keeper.found(Found(uav, vehicle))
        self.runner.advance(1.0)

    def told(self, kind: str, uav: str) -> list[str]:
        """All lines of a kind about a UAV."""
        return [n.text for n in self.notices if (n.kind, n.uav) == (kind, uav)]

    def until(self, kind: str, uav: str, timeout_s: float) -> str:
        """The first line of a kind about a UAV, once there is one."""
        assert self.runner.until(lambda: bool(self.told(kind, uav)), timeout_s), self.notices
        return self.told(kind, uav)[0]
