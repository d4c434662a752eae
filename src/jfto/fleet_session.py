"""The fleet that a command line names: real vehicles by a roster, or simulated ones."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from jfto.simulated_fleet import PadGround, Place, vehicle_configs
from jfto_mavlink.errors import RosterError
from jfto_mavlink.fleet.fly import Runner
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.roster import Roster, RosterEntry, parse_vehicles
from jfto_mavlink.fleet.station import StationSettings
from jfto_mavlink.io.address import free_udp_port, parse_address
from jfto_mavlink.io.signing import load_signer
from jfto_mavlink.protocol.setup import DEFAULT_RATES
from jfto_mavlink.protocol.timesync import Clock, ScaledClock
from jfto_msgs_py.records.event import Event
from jfto_sim.server import ServerSettings, SimServer

HEARD_WAIT_S = 30.0


@dataclass(frozen=True)
class FleetSession:
    """An open fleet: what runs its conversations, its clocks, and whether it is simulated."""

    runner: Runner
    clock: Clock
    unix: Clock
    simulated: bool


@contextmanager
def open_fleet(
    vehicles: Sequence[str],
    pads: Mapping[str, Place],
    *,
    speedup: float = 1.0,
    log_directory: Path | None = None,
    key_file: Path | None = None,
    on_event: Callable[[Event], None] | None = None,
    grounds: Mapping[str, PadGround] | None = None,
    complete: bool = True,
    rates: Mapping[int, float] = DEFAULT_RATES,
) -> Iterator[FleetSession]:
    """Open a fleet and wait until all of it is heard.

    `vehicles` is ("sim",), whose vehicles stand on `pads` (UAV name: latitude, longitude, height
    above sea level) over `grounds` and run `speedup` times faster than the clock, or links or
    entries of a roster as `parse_vehicles` takes them. With `complete` off, real vehicles that are
    not heard are no reason to stop: the others can still be called home. Raises RosterError,
    LinkError, SigningError.
    """
    roster = parse_vehicles(vehicles, tuple(pads))
    if roster is None:
        if key_file is not None:
            raise RosterError(201, "simulated vehicles start without a key; leave --key out.")
        with _simulated(pads, grounds or {}, speedup, log_directory, on_event, rates) as session:
            yield session
        return
    if speedup != 1.0:
        raise RosterError(201, "--speedup is for simulated vehicles (sim:N); real ones keep time.")
    signer = None if key_file is None else load_signer(key_file)
    settings = StationSettings(signer=signer, rates=rates, log_directory=log_directory)
    with FleetLink(roster, settings, on_event=on_event) as bridge:
        if complete:
            bridge.wait_heard(HEARD_WAIT_S)
        else:
            with suppress(RosterError):
                bridge.wait_heard(HEARD_WAIT_S / 6)
        yield FleetSession(bridge, bridge.clock, time.time, simulated=False)


@contextmanager
def _simulated(
    pads: Mapping[str, Place],
    grounds: Mapping[str, PadGround],
    speedup: float,
    log_directory: Path | None,
    on_event: Callable[[Event], None] | None,
    rates: Mapping[int, float],
) -> Iterator[FleetSession]:
    start_unix_s = time.time()
    link = parse_address(f"udpin:127.0.0.1:{free_udp_port()}")
    configs = vehicle_configs(pads, grounds, round(start_unix_s * 1e9))
    endpoint = (f"udpto:{link.host}:{link.number}",)
    settings = ServerSettings((endpoint,) * len(configs), speedup)
    roster = Roster(tuple(RosterEntry(uav, n, link) for n, uav in enumerate(pads, 1)))
    clock = ScaledClock(speedup)

    def unix() -> float:
        return start_unix_s + clock()

    with (
        SimServer(configs, settings),
        FleetLink(
            roster,
            StationSettings(rates=rates, log_directory=log_directory),
            clock=clock,
            unix=unix,
            on_event=on_event,
        ) as bridge,
    ):
        bridge.wait_heard(HEARD_WAIT_S * max(speedup, 1.0))
        yield FleetSession(bridge, clock, unix, simulated=True)
