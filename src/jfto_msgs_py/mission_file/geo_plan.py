"""A plan in degrees and metres above sea level: what is written into files of other programs."""

from __future__ import annotations

from dataclasses import dataclass

# Latitude and longitude in degrees, height above sea level in metres.
Position = tuple[float, float, float]
Ring = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class GeoStop:
    """One place of a route, and where the camera looks; without `photo` it is only passed.

    `number` is the waypoint's; `above_ground_m` is None over unknown terrain, `arrival_s` (from
    lift-off) where nothing is timed.
    """

    number: int
    at: Position
    yaw_deg: float
    pitch_deg: float
    photo: bool = True
    above_ground_m: float | None = None
    arrival_s: float | None = None


@dataclass(frozen=True)
class GeoRoute:
    """The `stops` of one UAV in order, the pad (`home`) and the `way_home` after them.

    `uav` is "" and `home` None for waypoints that nobody flies yet.
    """

    uav: str
    stops: tuple[GeoStop, ...]
    home: Position | None = None
    way_home: tuple[Position, ...] = ()
    speed_mps: float = 5.0


@dataclass(frozen=True)
class GeoArea:
    """A polygon with holes; rings are (latitude, longitude), without the first corner again.

    `bottom_m` and `top_m` are heights above sea level, None without limit.
    """

    name: str
    outer: Ring
    holes: tuple[Ring, ...] = ()
    bottom_m: float | None = None
    top_m: float | None = None


@dataclass(frozen=True)
class GeoPlan:
    """Routes, the surveyed `area`, and where may (`keep_in`) and may not (`keep_out`) be flown.

    `drone` names the type that DJI's waylines are for, as `write_wpml.DRONES` lists them.
    """

    name: str
    routes: tuple[GeoRoute, ...]
    area: tuple[GeoArea, ...] = ()
    keep_in: tuple[GeoArea, ...] = ()
    keep_out: tuple[GeoArea, ...] = ()
    drone: str = ""
