"""What the front hands to mavlink_bridge: simulated vehicles, and the terrain of a scenario."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from jfto.fleet_session import open_fleet
from jfto_mavlink.bridge import Bridge
from jfto_mavlink.mission.ground import Ground
from jfto_mavlink.open_vehicles import FleetRequest
from jfto_msgs_py.scenario import Scenario
from jfto_world.terrain import Dem


@contextmanager
def open_simulated(request: FleetRequest) -> Iterator[Bridge]:
    """Simulated vehicles on the plan's pads, heard; raises RosterError."""
    with open_fleet(
        [f"sim:{request.count}"],
        request.pads,
        speedup=request.speedup,
        log_directory=request.log_directory,
        on_event=request.on_event,
        rates=request.rates,
    ) as session:
        assert isinstance(session.runner, Bridge)
        yield session.runner


def dem_of(scenario: Scenario) -> Dem:
    """Terrain of a scenario; file names stand by themselves. Raises TerrainError."""
    from jfto.scenario_file import LoadedScenario
    from jfto.stages.survey import load_ground

    return load_ground(LoadedScenario(scenario, Path("parameters")))


def ground_of(scenario: Scenario) -> Ground:
    """Heights of a scenario's terrain; raises TerrainError."""
    return dem_of(scenario).height
