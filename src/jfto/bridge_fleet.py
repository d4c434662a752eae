"""What the front hands to mavlink_bridge: simulated vehicles."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.open_vehicles import FleetRequest


@contextmanager
def open_simulated(request: FleetRequest) -> Iterator[FleetLink]:
    """Simulated vehicles on the plan's pads, heard; raises RosterError."""
    # A bridge to real vehicles, started again in mid-flight, has no time to import a simulator.
    from jfto.fleet_session import open_fleet

    with open_fleet(
        [f"sim:{request.count}"],
        request.pads,
        speedup=request.speedup,
        log_directory=request.log_directory,
        on_event=request.on_event,
        rates=request.rates,
    ) as session:
        assert isinstance(session.runner, FleetLink)
        yield session.runner
