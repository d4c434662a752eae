"""A fleet with missions on board, flown in virtual time."""

from __future__ import annotations

from functools import partial

from jfto_mavlink.fleet.fly import Fleet, FlySettings, deliver_to_fleet, start_fleet
from jfto_mavlink.fleet.monitor import FlightMonitor
from jfto_mavlink.flight.control import (
    StartLine,
    start,
)
from jfto_mavlink.flight.follow import FlightTiming
from jfto_mavlink.flight.telemetry import LinkState, listen
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.protocol.exchange import Wait
from jfto_sim import Vehicle, VehicleConfig
from support.rehearsal import Rehearsal

READY_S = 45.0


class RehearsedFleet:
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
