"""Fleet-atomic delivery: every vehicle's mission verified on board, or none released."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol, TypeVar

from jfto_mavlink.errors import FlightError, RosterError
from jfto_mavlink.exchange import Context, Exchange, Report
from jfto_mavlink.mission.deliver import Delivered, deliver
from jfto_mavlink.mission.item import Mission
from jfto_mavlink.mission.transfer import Patience
from jfto_mavlink.roster import Roster
from jfto_mavlink.vehicle import Vehicle

T = TypeVar("T")
Reporter = Callable[[str, Report], None]


class Runner(Protocol):
    """What runs conversations with several vehicles at once (the bridge does)."""

    roster: Roster

    def run(
        self,
        jobs: Mapping[str, Callable[[Context], Exchange[T]]],
        report: Reporter | None = None,
    ) -> dict[str, T | Exception]:
        """Result or error per vehicle."""

    def vehicle(self, uav: str) -> Vehicle:
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
    patience: Patience | None = None,
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
        return lambda context: deliver(context, mission, patience)

    results = runner.run({uav: job(mission) for uav, mission in missions.items()}, report)
    delivered = {uav: r for uav, r in results.items() if isinstance(r, Delivered)}
    failed = {uav: r for uav, r in results.items() if isinstance(r, Exception)}
    return FleetDelivery(missions, delivered, failed)
