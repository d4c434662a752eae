"""Places of mission items over the ground of a scenario."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.mission_file import FileItem
from jfto_msgs_py.records.plan import Vector
from jfto_planner.coverage.raw_waypoint import from_geodetic, ground_height
from jfto_world.terrain import Dem

# MAV_FRAME numbers with and without _INT.
_SEA_LEVEL, _ABOVE_HOME, _ABOVE_GROUND = (0, 5), (3, 6), (10, 11)
# Elevation models differ by a few metres; beyond the second bound one of both is wrong.
_HOME_SAID_M, _HOME_REFUSED_M = 5.0, 20.0
_HOME_FAR_M = 10_000.0


@dataclass(frozen=True)
class Spot:
    """A place, ENU metres, and its height above ground where the file gives that."""

    position_m: Vector
    above_ground_m: float | None = None


class MissionPlaces:
    """From latitude, longitude and height in some frame to ENU metres.

    Planned home is held against the ground when the first height above it is met.
    """

    def __init__(
        self, source: str, dem: Dem, home: tuple[float, float, float] | None, notes: list[str]
    ) -> None:
        self._source, self._dem, self._home, self._notes = source, dem, home, notes
        self._home_alt_m: float | None = None

    def spot(self, item: FileItem) -> Spot:
        """Place of an item. Raises WaypointError for a frame or a place that cannot be used."""
        for index, name in ((4, "latitude"), (5, "longitude"), (6, "altitude")):
            if item.left_open[index]:
                raise WaypointError(f"{item.place}: {name} is None, must be a number. Give it one.")
        lat_deg, lon_deg, height_m = item.params[4:]
        frame = item.frame
        if frame in _ABOVE_HOME:
            height_m += self._home_altitude(item.place)
        elif frame not in _SEA_LEVEL + _ABOVE_GROUND:
            raise WaypointError(
                f"{item.place}: altitude frame {frame} is unknown. Use AMSL (0), relative to home "
                "(3) or above terrain (10)."
            )
        if frame not in _ABOVE_GROUND and self._dem.above_ellipsoid:
            raise WaypointError(
                f"{item.place}: its altitude is above sea level, but the terrain's heights are "
                f"above the {self._dem.height_datum}; these differ by up to 100 m. Give altitudes "
                "above terrain, or a terrain with heights above sea level."
            )
        above = frame in _ABOVE_GROUND
        position = from_geodetic(self._dem, lat_deg, lon_deg, height_m, above, item.place)
        return Spot(position, height_m if above else None)

    def take_off(self, item: FileItem) -> Spot | None:
        """Where a take-off ends, None if that cannot be told from the file."""
        if self._home is None or math.isnan(self._home[2]) or item.frame not in _ABOVE_HOME:
            return None
        if self._dem.above_ellipsoid:
            return None
        x, y, z = map(float, self._dem.to_enu(*self._home))
        return Spot((x, y, z + item.params[6]))

    def between(self, start: Spot | None, end: Spot, share: float) -> Spot:
        """The place at a share of a leg, which follows the ground where both ends do."""
        if start is None:
            return end
        x, y, z = (
            a + share * (b - a) for a, b in zip(start.position_m, end.position_m, strict=True)
        )
        if start.above_ground_m is None or end.above_ground_m is None:
            return Spot((x, y, z))
        height = start.above_ground_m + share * (end.above_ground_m - start.above_ground_m)
        return Spot((x, y, ground_height(self._dem, x, y, self._source) + height), height)

    def _home_altitude(self, place: str) -> float:
        if self._home is None:
            raise WaypointError(
                f"{place}: its altitude is relative to home, but plannedHomePosition is missing. "
                "Set the planned home and save the plan again."
            )
        if self._home_alt_m is None:
            self._home_alt_m = self._checked_home(*self._home)
        return self._home_alt_m

    def _checked_home(self, lat_deg: float, lon_deg: float, alt_m: float) -> float:
        what = f"{self._source}: the planned home (plannedHomePosition, row 0)"
        if math.isnan(alt_m):
            raise WaypointError(
                f"{what} has no altitude, but waypoints are relative to it. Give it one."
            )
        x, y = map(float, self._dem.to_enu(lat_deg, lon_deg, alt_m)[:2])
        if not self._dem.contains(x, y):
            away_m = math.hypot(x, y)
            text = f"{what} at {lat_deg:.5f}, {lon_deg:.5f} lies {away_m / 1000:.1f} km from the "
            if away_m > _HOME_FAR_M:
                raise WaypointError(
                    f"{text}scenario's origin, and waypoints are relative to its altitude. Move it "
                    "to where the vehicles start, and save the file again."
                )
            self._notes.append(
                f"{text}scenario's origin, outside of the terrain: its altitude of {alt_m:.1f} m, "
                "from which waypoints count, could not be compared with the ground"
            )
            return alt_m
        ground_m = float(self._dem.to_geodetic((x, y, float(self._dem.height(x, y))))[2])
        off_m = alt_m - ground_m
        text = (
            f"{what} has altitude {alt_m:.1f} m, but the ground there is at {ground_m:.1f} m, "
            f"{abs(off_m):.1f} m {'below' if off_m > 0 else 'above'} it"
        )
        if abs(off_m) > _HOME_REFUSED_M:
            raise WaypointError(
                f"{text}; waypoints are relative to it. Set its altitude to {ground_m:.1f} and "
                "save the file again, or declare terrain.vertical_datum if the terrain's heights "
                f"are not above {self._dem.height_datum}."
            )
        if abs(off_m) > _HOME_SAID_M:
            self._notes.append(f"{text}; waypoints are relative to it")
        return alt_m
