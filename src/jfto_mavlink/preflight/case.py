"""One vehicle's case: its mission, what it says of itself, and what it must show."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.preflight.facts import Aboard, Snapshot
from jfto_mavlink.preflight.settings import GateSettings
from jfto_mavlink.protocol.item import FRAME_ABSOLUTE, offset_m
from jfto_msgs_py.types import Array


@dataclass(frozen=True)
class Case:
    """What the checks of one vehicle go by."""

    mission: VehicleMission
    now: Snapshot
    aboard: Aboard
    settings: GateSettings

    def value(self, name: str, default: float = 0.0) -> float:
        """A parameter as it will be in flight: the mission's, else the vehicle's own."""
        return dict(self.mission.mission.parameters).get(name, self.aboard.get(name, default))

    @cached_property
    def path_m(self) -> Array:
        """Corners of what is flown until the way home begins: (M, 3) east, north, up of home."""
        path = mission_path(self.mission)
        curve = self.settings.curves_m.get(self.mission.uav)
        return path if curve is None else np.vstack([path, curve - np.array(self.mission.pad_m)])


def mission_path(mission: VehicleMission) -> Array:
    """Home, the take-off above it and every place that the items lead to: (M, 3) ENU of home."""
    lat, lon, alt_m = mission.home_deg_m
    points = [(0.0, 0.0, 0.0)]
    for item in mission.mission.items[1:]:
        if item.command == mavlink.MAV_CMD_NAV_TAKEOFF:
            points.append((0.0, 0.0, item.z))
        elif item.command == mavlink.MAV_CMD_NAV_LAND:
            # Straight down, where a fence has no floor.
            continue
        elif item.is_nav and item.has_position and (item.x or item.y):
            up = item.z - alt_m if item.frame == FRAME_ABSOLUTE else item.z
            east, north, _ = offset_m((lat, lon, 0.0), (item.lat_deg, item.lon_deg, 0.0))
            points.append((east, north, up))
    return np.array(points)
