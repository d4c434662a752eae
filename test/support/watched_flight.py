"""Simulated flights in virtual time, and the record of the flight that listens to them."""

from __future__ import annotations

from functools import partial

from jfto_mavlink.fleet.fly import Fleet, FlySettings, deliver_to_fleet, start_fleet
from jfto_mavlink.fleet.watched_flight import WatchedFlight, recognise
from jfto_mavlink.flight.telemetry import LOST_AFTER_S, LinkState, listen
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_msgs_py.records.event import DEBUG
from jfto_sim import Vehicle, VehicleConfig
from support.rehearsal import Rehearsal

READY_S = 45.0
FAILSAFES = {"BATT_FS_LOW_ACT": 2.0, "BATT_LOW_VOLT": 11.0}


class Flight:
    """Simulated vehicles of a plan on their missions, and what an operator is told.

    Times are the vehicles' own UTC. `vehicles` are those of another flight that go on, `path` is
    where the state of the flight is kept.
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
        self.events = []
        self.lift_offs = []
        self.watched = WatchedFlight(
            self.missions,
            path,
            LOST_AFTER_S,
            self.events.append,
            self.lift_offs.append,
            self,
        )
        self.watched.begin()
        for uav, mission in self.missions.items():
            job = partial(
                listen, mission=mission, sink=self._take, under_way=self.watched.under_way
            )
            self.runner.start(uav, job)

    def begun_ns(self, moment) -> int | None:
        return moment.utc_ns

    def own_s(self, context, at_ns: int) -> float | None:
        return context.vehicle.boot_s(at_ns)

    @property
    def notices(self):
        """What an operator must learn of."""
        return [event for event in self.events if event.level > DEBUG]

    @property
    def monitor(self):
        return self.watched.monitor

    def _take(self, sample) -> None:
        if isinstance(sample, LinkState):
            self.watched.take(sample)

    def start(self) -> None:
        """Upload, start, and wait for the fleet's lift-off."""
        self.runner.advance(READY_S)
        missions = {uav: mission.mission for uav, mission in self.missions.items()}
        release = deliver_to_fleet(self.runner, missions).release()
        start_fleet(Fleet(self.runner, self.missions), release, FlySettings())
        self.until("lift_off", "", 10.0)

    def recognise(self) -> None:
        """What a bridge does first of all."""
        jobs = {
            u: partial(recognise, mission=m.mission, heard_wait_s=15.0)
            for u, m in self.missions.items()
        }
        for vehicle in self.runner.run(jobs).values():
            self.watched.found(vehicle)
        self.runner.advance(1.0)

    def told(self, kind: str, uav: str) -> list[str]:
        """All lines of a kind about a UAV."""
        return [n.text for n in self.notices if (n.kind, n.uav_id) == (kind, uav)]

    def until(self, kind: str, uav: str, timeout_s: float) -> str:
        """The first line of a kind about a UAV, once there is one."""
        assert self.runner.until(lambda: bool(self.told(kind, uav)), timeout_s), self.notices
        return self.told(kind, uav)[0]
