"""Between the plan's map and the autopilot's local frame, whose origin is the EKF's."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_mavlink.flight.place import Place
from jfto_msgs_py.types import Array
from jfto_world.terrain.frame import LocalFrame

# The autopilot's own approximation: metres per degree of latitude, everywhere on Earth.
METRES_PER_DEGREE = 0.011131884502145034 * 1e7


@dataclass(frozen=True)
class MapFrame:
    """The plan's ENU map as one vehicle sees it, which counts heights from its home.

    The plan's heights are in the datum of its terrain, the vehicle's in that of its GPS; at the pad
    both are the same place. `pad_alt_m` is the pad's altitude in the plan's datum.
    """

    frame: LocalFrame
    pad_alt_m: float

    def position_m(self, lat_deg: float, lon_deg: float, height_m: float) -> Array:
        """ENU position (3,) of a place given by its height above home."""
        return self.frame.to_enu(lat_deg, lon_deg, self.pad_alt_m + height_m)

    def place(self, position_m: Array) -> Place:
        """Latitude, longitude and height above home of an ENU position (3,)."""
        lat, lon, alt = self.frame.to_geodetic(position_m)
        return float(lat), float(lon), float(alt) - self.pad_alt_m


@dataclass(frozen=True)
class EkfFrame:
    """North, east, down of the EKF origin. Altitudes here are above sea level, by the vehicle.

    `origin` is its GPS_GLOBAL_ORIGIN, `home_alt_m` the altitude in its HOME_POSITION.
    """

    map: MapFrame
    origin: Place
    home_alt_m: float

    def position_ned_m(self, position_m: Array) -> tuple[float, float, float]:
        """NED of an ENU position (3,) of the map.

        By the formula that the autopilot itself uses, so that it ends up at that very latitude and
        longitude: true metres would be 2 m per kilometre beside.
        """
        lat, lon, height_m = self.map.place(position_m)
        lat_0, lon_0, alt_0 = self.origin
        shrink = max(math.cos(math.radians((lat + lat_0) / 2)), 0.01)
        turn = (lon - lon_0 + 180.0) % 360.0 - 180.0
        north = (lat - lat_0) * METRES_PER_DEGREE
        return north, turn * METRES_PER_DEGREE * shrink, alt_0 - self.home_alt_m - height_m


def ned(vector: Array) -> tuple[float, float, float]:
    """North, east, down of an ENU velocity or acceleration (3,)."""
    return float(vector[1]), float(vector[0]), -float(vector[2])
