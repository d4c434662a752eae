"""A whole scenario: every part, every key."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from dataclasses import dataclass, field
from typing import Any

from jfto_msgs_py.records.fields import Key, keys_of
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.scenario.fence import FencePart
from jfto_msgs_py.scenario.fleet import FleetPart, StartsPart
from jfto_msgs_py.scenario.mission import EvaluationPart, MissionPart, NetworkPart, SearchPart
from jfto_msgs_py.scenario.simulation import SimulationPart
from jfto_msgs_py.scenario.sorties import SortiesPart
from jfto_msgs_py.scenario.survey import (
    AreaPart,
    CameraPart,
    CoveragePart,
    TerrainPart,
    WaypointsPart,
)
from jfto_msgs_py.scenario.trajectory import TrajectoryPart


@dataclass(frozen=True)
class Scenario:
    """Everything a run depends on, resolved: per-UAV arrays have one entry per UAV."""

    terrain: TerrainPart = field(default_factory=TerrainPart)
    area: AreaPart = field(default_factory=AreaPart)
    fence: FencePart = field(default_factory=FencePart)
    waypoints: WaypointsPart = field(default_factory=WaypointsPart)
    camera: CameraPart = field(default_factory=CameraPart)
    coverage: CoveragePart = field(default_factory=CoveragePart)
    fleet: FleetPart = field(default_factory=FleetPart)
    starts: StartsPart = field(default_factory=StartsPart)
    sorties: SortiesPart = field(default_factory=SortiesPart)
    radio: Radio = field(default_factory=Radio)
    network: NetworkPart = field(default_factory=NetworkPart)
    mission: MissionPart = field(default_factory=MissionPart)
    trajectory: TrajectoryPart = field(default_factory=TrajectoryPart)
    search: SearchPart = field(default_factory=SearchPart)
    evaluation: EvaluationPart = field(default_factory=EvaluationPart)
    simulation: SimulationPart = field(default_factory=SimulationPart)

    def values(self) -> dict[str, Any]:
        """Value of every key by its dotted name, in the order of the schema."""
        return {
            f"{part.name}.{key.name}": getattr(getattr(self, part.name), key.name)
            for part in dataclasses.fields(self)
            for key in dataclasses.fields(getattr(self, part.name))
        }

    def scenario_hash(self) -> str:
        """SHA-256 of the values that decide the result, apart from the seed of the search."""
        decisive = {
            name: value
            for name, value in self.values().items()
            if KEYS[name].hashed and not (KEYS[name].later and KEYS[name].is_default(value))
        }
        return hashlib.sha256(json.dumps(decisive, sort_keys=True).encode()).hexdigest()


PARTS: dict[str, type] = {
    "terrain": TerrainPart,
    "area": AreaPart,
    "fence": FencePart,
    "waypoints": WaypointsPart,
    "camera": CameraPart,
    "coverage": CoveragePart,
    "fleet": FleetPart,
    "starts": StartsPart,
    "sorties": SortiesPart,
    "radio": Radio,
    "network": NetworkPart,
    "mission": MissionPart,
    "trajectory": TrajectoryPart,
    "search": SearchPart,
    "evaluation": EvaluationPart,
    "simulation": SimulationPart,
}
KEYS: dict[str, Key] = {
    key.name: key for prefix, part in PARTS.items() for key in keys_of(part, prefix)
}
# Short-hand keys and the keys that they set.
RADIO_SHORTHANDS = {"radio.antenna_gain_dbi": ("radio.gain_tx_dbi", "radio.gain_rx_dbi")}
