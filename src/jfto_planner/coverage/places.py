"""Places of files over the ground of a scenario: the one way from their heights to metres."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_msgs_py.errors import TerrainError, WaypointError
from jfto_msgs_py.mission_file import Above, FileItem, FilePoint, MissionDocument
from jfto_msgs_py.mission_file.document import ABOVE_ELLIPSOID
from jfto_msgs_py.records.plan import Vector
from jfto_world.terrain import Dem

# MAV_FRAME numbers with and without _INT.
_FRAMES = {
    **dict.fromkeys((0, 5), Above.SEA_LEVEL),
    **dict.fromkeys((3, 6), Above.HOME),
    **dict.fromkeys((10, 11), Above.GROUND),
    ABOVE_ELLIPSOID: Above.ELLIPSOID,
}
# Elevation models differ by a few metres; beyond the second bound one of both is wrong.
_HOME_SAID_M, _HOME_REFUSED_M = 5.0, 20.0
_HOME_FAR_M = 10_000.0


@dataclass(frozen=True)
class Assumed:
    """What counts where a file is silent: home (latitude, longitude), on the ground there.

    `clamped_m` is how far above ground points are that a file lays on the ground; None refuses
    them.
    """

    home_deg: tuple[float, float] | None = None
    clamped_m: float | None = None


@dataclass(frozen=True)
class Spot:
    """A place, ENU metres, and its height above ground where the file gives that."""

    position_m: Vector
    above_ground_m: float | None = None


class Places:
    """From latitude, longitude and height above something to ENU metres.

    Home is held against the ground when the first height above it is met; `notes` get what is
    assumed.
    """

    def __init__(
        self,
        source: str,
        dem: Dem,
        notes: list[str],
        assumed: Assumed | None = None,
        document: MissionDocument | None = None,
    ) -> None:
        self._source, self._dem, self._notes = source, dem, notes
        self._assumed = assumed or Assumed()
        self._home = None if document is None else document.home
        self._on_ground = document is not None and document.home_on_ground
        self._unnamed_by = "" if document is None else document.home_unnamed_by
        self._is_mission = document is not None and not document.home_on_ground
        self._home_alt_m: float | None = None
        self._clamped = 0
        self._told_geoid = False

    def point(self, point: FilePoint) -> Vector:
        """Place of a point of a file. Raises WaypointError."""
        if not point.local:
            return self.at(*point.at, point.height_m, point.above, point.place).position_m
        x, y = point.at
        if point.above in (Above.GROUND, Above.CLAMPED):
            height_m = point.height_m if point.above == Above.GROUND else self._clamp(point.place)
            return (x, y, self._ground(x, y, point.place) + height_m)
        if point.above == Above.UNSAID:
            return (x, y, point.height_m)
        raise WaypointError(
            f"{point.place}: a height above {point.above.value} needs latitude and longitude. Give "
            "these, or z_m."
        )

    def spot(self, item: FileItem) -> Spot:
        """Place of an item. Raises WaypointError for a frame or a place that cannot be used."""
        for index, name in ((4, "latitude"), (5, "longitude"), (6, "altitude")):
            if item.left_open[index]:
                raise WaypointError(f"{item.place}: {name} is None, must be a number. Give it one.")
        above = _FRAMES.get(item.frame)
        if above is None:
            raise WaypointError(
                f"{item.place}: altitude frame {item.frame} is unknown. Use AMSL (0), relative to "
                "home (3) or above terrain (10)."
            )
        lat_deg, lon_deg, height_m = item.params[4:]
        return self.at(lat_deg, lon_deg, height_m, above, item.place)

    def at(self, lat_deg: float, lon_deg: float, height_m: float, above: Above, place: str) -> Spot:
        """Place of a height above what `above` says. Raises WaypointError."""
        if not (-90 <= lat_deg <= 90 and -180 <= lon_deg <= 180):
            raise WaypointError(
                f"{place}: ({lat_deg}, {lon_deg}) is not a latitude and longitude in degrees. "
                "Check that they are not exchanged."
            )
        if above in (Above.GROUND, Above.CLAMPED):
            if above == Above.CLAMPED:
                height_m = self._clamp(place)
            x, y, _ = self._enu(lat_deg, lon_deg, self._dem.origin.alt_m)
            up = self._ground(x, y, place) + height_m
            # Higher up the same degrees are farther apart: 1 cm at 150 m away and 400 m up.
            x, y, _ = self._enu(lat_deg, lon_deg, float(self._dem.to_geodetic((x, y, up))[2]))
            return Spot((x, y, self._ground(x, y, place) + height_m), height_m)
        if above == Above.HOME:
            altitude_m = height_m + self._home_altitude(place)
        else:
            altitude_m = height_m + self._datum_shift(above, lat_deg, lon_deg)
        return Spot(self._enu(lat_deg, lon_deg, altitude_m))

    def take_off(self, item: FileItem) -> Spot | None:
        """Where a take-off ends, None if that cannot be told from the file."""
        if self._home is None or math.isnan(self._home[2]):
            return None
        if _FRAMES.get(item.frame) != Above.HOME:
            return None
        x, y, z = self._enu(*self._home)
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
        return Spot((x, y, self._ground(x, y, self._source) + height), height)

    def finish(self) -> None:
        """Say in a line how many points were laid on the ground."""
        if self._clamped:
            self._notes.append(
                f"{self._source}: {self._clamped} points lie on the ground (clampToGround); they "
                f"are flown {self._assumed.clamped_m:g} m above it (waypoints.height_m)"
            )

    def _enu(self, lat_deg: float, lon_deg: float, alt_m: float) -> Vector:
        x, y, z = (float(value) for value in self._dem.to_enu(lat_deg, lon_deg, alt_m))
        return (x, y, z)

    def _ground(self, x_m: float, y_m: float, place: str) -> float:
        try:
            return float(self._dem.height(x_m, y_m))
        except TerrainError as error:
            raise WaypointError(f"{place}: {error}") from error

    def _clamp(self, place: str) -> float:
        if self._assumed.clamped_m is None:
            raise WaypointError(
                f"{place}: lies on the ground (clampToGround). Set its altitude mode to "
                "relativeToGround, and a height."
            )
        self._clamped += 1
        return self._assumed.clamped_m

    def _datum_shift(self, above: Above, lat_deg: float, lon_deg: float) -> float:
        """Metres to add to bring a height to sea level, where the terrain's are."""
        if above != Above.ELLIPSOID:
            return 0.0
        # Loaded here: it brings GDAL along, and few files need it.
        from jfto_world.terrain.geoid import geoid_height, geoid_name

        geoid_m = float(geoid_height(lat_deg, lon_deg))
        if not self._told_geoid:
            self._told_geoid = True
            self._notes.append(
                f"{self._source}: altitudes above the ellipsoid are brought to sea level, as the "
                f"terrain's, by {geoid_name()}: {-geoid_m:+.1f} m at the first"
            )
        return -geoid_m

    def _home_altitude(self, place: str) -> float:
        if self._home_alt_m is not None:
            return self._home_alt_m
        if self._home is None and self._assumed.home_deg is not None:
            self._home_alt_m = self._home_on_ground(self._assumed.home_deg, "waypoints.home_deg")
        elif self._home is None and self._unnamed_by:
            raise WaypointError(
                f"{place}: its altitude is relative to home. {self._unnamed_by} names no home; set "
                "waypoints.home_deg=LAT,LON to where the vehicle starts."
            )
        elif self._home is None:
            cure = (
                "but plannedHomePosition is missing. Set the planned home and save the plan again"
                if self._is_mission
                else "the place of take-off, which the file does not name. Name it there"
            )
            raise WaypointError(
                f"{place}: its altitude is relative to home, {cure}, or set waypoints.home_deg to "
                "where the vehicles start."
            )
        elif self._on_ground:
            self._home_alt_m = self._home_on_ground(self._home[:2], f"{self._source}: its take-off")
        else:
            self._home_alt_m = self._checked_home(*self._home)
        return self._home_alt_m

    def _home_on_ground(self, home_deg: tuple[float, float], what: str) -> float:
        """Altitude of the ground at a home. Raises WaypointError outside of the terrain."""
        x, y, _ = self._enu(*home_deg, self._dem.origin.alt_m)
        if not self._dem.contains(x, y):
            raise WaypointError(
                f"{what} at {home_deg[0]:.5f}, {home_deg[1]:.5f} lies "
                f"{math.hypot(x, y) / 1000:.1f} km from the scenario's origin, outside of the "
                "terrain, and heights count from the ground there. Move it, or enlarge "
                "terrain.size_m."
            )
        alt_m = float(self._dem.to_geodetic((x, y, float(self._dem.height(x, y))))[2])
        self._notes.append(
            f"{self._source}: heights above home count from the ground at {home_deg[0]:.5f}, "
            f"{home_deg[1]:.5f}, {alt_m:.1f} m"
        )
        return alt_m

    def _checked_home(self, lat_deg: float, lon_deg: float, alt_m: float) -> float:
        what = f"{self._source}: the planned home (plannedHomePosition, row 0)"
        if math.isnan(alt_m):
            raise WaypointError(
                f"{what} has no altitude, but waypoints are relative to it. Give it one."
            )
        x, y, _ = self._enu(lat_deg, lon_deg, alt_m)
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
