"""Direct links to a fleet, where no graph is needed: real vehicles by a roster, or simulated."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import click

from jfto.simulation.fleet import UPTIME_S, vehicle_configs
from jfto_mavlink.errors import RosterError, SigningError
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.roster import Roster, RosterEntry, parse_vehicles
from jfto_mavlink.fleet.station import StationSettings
from jfto_mavlink.io.address import free_udp_port, parse_address
from jfto_mavlink.io.signing import load_signer
from jfto_mavlink.protocol.timesync import ScaledClock
from jfto_msgs_py.records.plan import Plan
from jfto_sim.server import ServerSettings, SimServer

LINK_WAIT_S = 30.0


@dataclass(frozen=True)
class Simulated:
    """How vehicles are simulated: `speedup` times real time, with fault lines from the start."""

    speedup: float = 1.0
    faults: tuple[str, ...] = ()


@contextmanager
def open_fleet(
    vehicles: Sequence[str],
    plan: Plan | None = None,
    *,
    simulated: Simulated = Simulated(),
    key_file: Path | None = None,
    complete: bool = True,
    uavs: Sequence[str] = (),
    endpoints: Sequence[str] = (),
) -> Iterator[FleetLink]:
    """Links to a fleet, once all of it has reported.

    `vehicles` is ("sim",), whose vehicles stand on the pads of the plan and are `simulated` so,
    or links or entries of a roster as `parse_vehicles` takes them. With
    `complete` off, real vehicles that are silent are no reason to stop: the others can still be
    called home. Links without a plan are those of `uavs`; `endpoints` are those of entries
    without one. Who is waited for is said on stderr. Raises RosterError, LinkError, SigningError.
    """
    uavs = uavs if plan is None else tuple(uav.id for uav in plan.uavs)
    roster = parse_vehicles(vehicles, uavs, endpoints)
    if roster is None:
        if key_file is not None:
            raise RosterError(201, "simulated vehicles start without a key; leave --key out.")
        if plan is None:
            raise RosterError(
                201,
                "simulated vehicles stand on the pads of a plan, and there is none here. Start "
                "them with jfto sim, and name their link.",
            )
        with _simulated(plan, simulated) as link:
            yield link
        return
    if simulated.speedup != 1.0:
        raise RosterError(201, "--speedup is for simulated vehicles (sim:N); real ones keep time.")
    signer = None if key_file is None else load_signer(key_file)
    with FleetLink(roster, StationSettings(signer=signer)) as link:
        if complete:
            link.wait_heard(LINK_WAIT_S, _say)
        else:
            with suppress(RosterError, SigningError):
                link.wait_heard(LINK_WAIT_S / 6, _say)
        yield link


@contextmanager
def _simulated(plan: Plan, how: Simulated) -> Iterator[FleetLink]:
    start_s, speedup = time.time(), how.speedup
    address = parse_address(f"udpin:127.0.0.1:{free_udp_port()}")
    configs = vehicle_configs(plan, round((start_s - UPTIME_S) * 1e9))
    endpoint = (f"udpto:{address.host}:{address.number}",)
    endpoints = (endpoint,) * len(configs)
    settings = ServerSettings(endpoints, speedup, faults=how.faults, uptime_s=UPTIME_S)
    roster = Roster(tuple(RosterEntry(uav.id, n, address) for n, uav in enumerate(plan.uavs, 1)))
    clock = ScaledClock(speedup)
    with (
        SimServer(configs, settings),
        FleetLink(roster, clock=clock, unix=lambda: start_s + clock()) as link,
    ):
        link.wait_heard(LINK_WAIT_S * max(speedup, 1.0), _say)
        yield link


def _say(text: str) -> None:
    click.echo(text, err=True)
