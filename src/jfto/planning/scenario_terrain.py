"""The terrain of a node's scenario, which the front hands to nodes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jfto_mavlink.mission.limits import Ground
    from jfto_msgs_py.scenario import Scenario
    from jfto_world.terrain import Dem


def dem_of(scenario: Scenario) -> Dem:
    """Terrain of a scenario; file names stand by themselves. Raises TerrainError."""
    from jfto.planning.scenario_file import LoadedScenario
    from jfto.planning.survey import load_ground

    return load_ground(LoadedScenario(scenario, Path("parameters")))


def ground_of(scenario: Scenario) -> Ground:
    """Heights of a scenario's terrain; raises TerrainError."""
    return dem_of(scenario).height
