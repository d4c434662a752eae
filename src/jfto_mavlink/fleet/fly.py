"""A fleet from its missions into the air: all verified on board or none released, then started."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, TypeVar

from jfto_mavlink.errors import FlightError, RosterError
from jfto_mavlink.fleet.roster import Roster
from jfto_mavlink.flight.control import StartLine, return_home, start, unless_called_off
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.mission.changed import (
    ChangedParameters,
    apply_parameters,
    restore_parameters,
)
from jfto_mavlink.mission.deliver import Delivered, deliver
from jfto_mavlink.preflight.facts import Surveyed
from jfto_mavlink.preflight.gate import inspect
from jfto_mavlink.preflight.judge import judge
from jfto_mavlink.preflight.page import Preflight
from jfto_mavlink.preflight.settings import GateSettings
from jfto_mavlink.protocol.exchange import Context, Exchange, Report
from jfto_mavlink.protocol.item import Mission
from jfto_mavlink.protocol.transfer import POLICY, TransferPolicy
from jfto_mavlink.protocol.vehicle_state import VehicleState

T = TypeVar("T")
Reporter = Callable[[str, Report], None]


class Runner(Protocol):
    """What runs conversations with the vehicles of a roster (the fleet's link does)."""

    roster: Roster

    @property
    def lost_after_s(self) -> float:
        """Silence after which a vehicle is lost."""

    def clock(self) -> float:
        """Seconds that conversations and silences are counted in."""

    def start(
        self,
        uav: str,
        job: Callable[[Context], Exchange[T]],
        report: Reporter | None = None,
    ) -> Any:
        """Begin a conversation that goes on by itself."""

    def run(
        self,
        jobs: Mapping[str, Callable[[Context], Exchange[T]]],
        report: Reporter | None = None,
    ) -> dict[str, T | Exception]:
        """Result or error per vehicle."""

    def vehicle(self, uav: str) -> VehicleState:
        """State of a vehicle as last heard."""


@dataclass(frozen=True)
class Release:
    """Permission to fly: each vehicle was seen to hold exactly this mission."""

    missions: Mapping[str, Mission]
    digests: Mapping[str, str]


@dataclass(frozen=True)
class FleetDelivery:
    """What became of an upload to a fleet."""

    missions: Mapping[str, Mission]
    delivered: Mapping[str, Delivered]
    failed: Mapping[str, Exception]

    def release(self) -> Release:
        """The permission to fly; raises FlightError 406 naming every vehicle that failed."""
        if self.failed:
            reasons = " ".join(str(error) for error in self.failed.values())
            raise FlightError(406, f"No vehicle is released: {reasons}")
        return Release(self.missions, {uav: d.digest for uav, d in self.delivered.items()})


def deliver_to_fleet(
    runner: Runner,
    missions: Mapping[str, Mission],
    report: Reporter | None = None,
    policy: TransferPolicy = POLICY,
) -> FleetDelivery:
    """Upload to all vehicles at once, read back and compare; ends with a result for each.

    Raises RosterError 205 before anything is sent if missions and roster do not name the same
    vehicles.
    """
    odd = set(missions) ^ set(runner.roster.uavs)
    if odd:
        raise RosterError(
            205, f"{', '.join(sorted(odd))}: named by the roster or by the missions, not by both."
        )

    def job(mission: Mission) -> Callable[[Context], Exchange[Delivered]]:
        return lambda context: deliver(context, mission, policy)

    results = runner.run({uav: job(mission) for uav, mission in missions.items()}, report)
    delivered = {uav: r for uav, r in results.items() if isinstance(r, Delivered)}
    failed = {uav: r for uav, r in results.items() if isinstance(r, Exception)}
    return FleetDelivery(missions, delivered, failed)


# Time for mode changes and arming before the first vehicle's moment.
PREPARE_S = 8.0


@dataclass(frozen=True)
class FlySettings:
    """`start_at_s` is the moment of the start on the link's clock, for missions with time gates.

    None starts as soon as all are ready.
    """

    start_at_s: float | None = None
    gate: GateSettings = field(default_factory=GateSettings)


@dataclass(frozen=True)
class Fleet:
    """Vehicles that can be spoken to, the missions they are to fly, and who is told how it goes.

    `changed` keeps what their parameters were before a flight, `show` is given each page of checks.
    """

    runner: Runner
    missions: Mapping[str, VehicleMission]
    report: Reporter | None = None
    changed: ChangedParameters = field(default_factory=ChangedParameters)
    show: Callable[[Preflight], None] = lambda _page: None

    def run(self, job: Callable[[Context], Exchange[T]]) -> dict[str, T | Exception]:
        """The same conversation with all vehicles at once: result or error of each."""
        return self.runner.run(dict.fromkeys(self.missions, job), self.report)


def preflight(
    fleet: Fleet, settings: GateSettings, release: Release | None = None, *, wait: bool = True
) -> Preflight:
    """Ask all vehicles, hold what they say against their missions; changes nothing.

    With `wait` they may take their time to become ready; with `release` the missions on board are
    read back.
    """

    def job(context: Context) -> Exchange[Surveyed]:
        released = None if release is None else release.missions[context.uav]
        return inspect(context, fleet.missions[context.uav], settings, wait=wait, released=released)

    found: dict[str, Surveyed | Exception] = dict(fleet.run(job))
    # Who answers under one system id may have come out meanwhile.
    for uav, result in fleet.run(_nothing).items():
        if isinstance(result, Exception):
            found[uav] = result
    page = judge(fleet.missions, found, settings)
    fleet.show(page)
    return page


def _nothing(_context: Context) -> Exchange[None]:
    return
    yield


def check_upload(fleet: Fleet, settings: GateSettings) -> None:
    """Refuse what the vehicles would meet in flight, before any of it is sent; FlightError 601."""
    looking = replace(settings, waited_for=True)
    stops = preflight(fleet, looking, wait=False).stops(uploading=True)
    if stops:
        raise FlightError(601, f"Nothing is uploaded. {' '.join(_sentence(s) for s in stops)}")


def check_fleet(fleet: Fleet, release: Release | None, settings: GateSettings) -> None:
    """Hold every vehicle at the gate; raises FlightError 601 with all that speaks against it.

    Missions on board are compared where there is a release.
    """
    stops = preflight(fleet, settings, release).stops()
    if stops:
        raise FlightError(601, f"No vehicle is armed. {' '.join(_sentence(s) for s in stops)}")


def _sentence(text: str) -> str:
    return text if text.endswith((".", '"')) else f"{text}."


def set_parameters(fleet: Fleet) -> None:
    """Set what the missions rely on; raises FlightError 601 where one does not take it."""
    results = fleet.run(
        lambda context: apply_parameters(
            context, fleet.missions[context.uav].mission.parameters, fleet.changed
        )
    )
    failed = [str(result) for result in results.values() if isinstance(result, Exception)]
    if failed:
        raise FlightError(601, " ".join(["No vehicle is armed.", *failed]))


def restore_fleet(fleet: Fleet) -> list[str]:
    """Put back what was set for a flight, on all vehicles that are down; returns what failed."""
    chosen = [
        uav
        for uav in fleet.changed.vehicles
        if uav in fleet.missions and not fleet.runner.vehicle(uav).in_flight
    ]
    results = fleet.runner.run(
        dict.fromkeys(chosen, lambda context: restore_parameters(context, fleet.changed)),
        fleet.report,
    )
    return [str(result) for result in results.values() if isinstance(result, Exception)]


def start_fleet(
    fleet: Fleet,
    release: Release,
    settings: FlySettings,
    begun: Callable[[StartLine], None] = lambda _line: None,
) -> None:
    """Check and start all vehicles, and leave them to their missions once they fly.

    `begun` is given the line before anybody arms: a text in its `failed` holds everybody back. If
    one does not start, those in the air are called home and FlightError 603 says so.
    """
    line = _checked_line(fleet, release, settings)
    begun(line)
    start_together(fleet, line, lambda context: start(context, line))


def start_together(fleet: Fleet, line: StartLine, job: Callable[[Context], Exchange[Any]]) -> None:
    """Start all vehicles of a line; raises FlightError 603 and calls all home if one does not."""
    results = fleet.run(lambda context: unless_called_off(line, job(context)))
    failed = {uav: r for uav, r in results.items() if isinstance(r, Exception)}
    if not failed:
        return
    reasons = " ".join(str(error) for error in failed.values())
    flying = [uav for uav in results if uav not in failed]
    recalled = fleet.runner.run(dict.fromkeys(flying, return_home), fleet.report)
    lost = [str(error) for error in recalled.values() if isinstance(error, Exception)]
    after = f" Called home: {', '.join(flying)}." if flying else ""
    raise FlightError(603, " ".join([f"The start was broken off: {reasons}{after}", *lost]))


def _checked_line(fleet: Fleet, release: Release, settings: FlySettings) -> StartLine:
    """Who starts when, after all have passed the gate with the missions released."""
    missions = fleet.missions
    stale = [u for u, m in missions.items() if release.digests.get(u) != m.digest]
    if stale or set(release.digests) != set(missions):
        raise FlightError(602, f"{', '.join(stale) or 'the fleet'}: not the released mission.")
    check_fleet(fleet, release, settings.gate)
    set_parameters(fleet)
    begin_s = fleet.runner.clock() + PREPARE_S
    if settings.start_at_s is not None:
        if settings.start_at_s < begin_s:
            raise FlightError(
                601,
                f"the fleet was ready {begin_s - settings.start_at_s:.0f} s too late for its time "
                "gates; no vehicle is armed. Leave more time before the start.",
            )
        begin_s = settings.start_at_s
    return StartLine(dict.fromkeys(missions, begin_s))
