"""What is surveyed and how: the ground, the waypoints over it, the camera and what it must see."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param

SOURCES = ("coverage", "file", "uniform", "gaussian")


@dataclass(frozen=True)
class AreaPart:
    """What is to be photographed, as polygons; without, the rectangle of `terrain`."""

    file: str = param(
        "",
        "Polygons of the area: a KML, KMZ, GeoJSON, Shapefile (also zipped), GeoPackage or "
        "QGroundControl .plan file (its surveys), in any coordinate system, relative to the "
        "scenario file.",
    )
    layer: str = param(
        "", "Layer of area.file (a folder in KML). Left out: the only one with polygons."
    )
    polygon_deg: tuple[float, ...] = param(
        (),
        "Corners of the area instead of a file: latitude, longitude, latitude, longitude, …, "
        "WGS-84.",
        unit="deg",
        low=-180.0,
        high=360.0,
    )
    buffer_m: float = param(
        0.0,
        "How far the area is widened all around, corners rounded; below 0: narrowed.",
        unit="m",
        low=-1000.0,
        high=1000.0,
    )


@dataclass(frozen=True)
class TerrainPart:
    """Elevation model and the rectangle of it that is to be photographed."""

    source: str = param(
        "jacksboro",
        "Elevation model: a GeoTIFF, SRTM .hgt, Esri ASCII, .vrt or ArduPilot's .DAT file, also "
        "packed as .zip or .gz, or a folder of tiles, relative to the scenario "
        'file; "jacksboro", the built-in USGS tile; or "unknown", where a plan is flown of which '
        "no more is known.",
    )
    surface: str = param(
        "",
        "Surface model (trees, roofs) over terrain.source, in any form that that has: photos are "
        "taken of the ground, clearance and lines of sight are held against the higher of both. "
        "Left out: only the ground is known.",
        later=True,
    )
    center_deg: tuple[float, ...] = param(
        (),
        "Latitude and longitude of the middle of the area, WGS-84, where the local frame sits. "
        "Left out: the middle of the polygons of area, else of the tile.",
        unit="deg",
        low=-180.0,
        high=180.0,
        length=2,
    )
    size_m: tuple[float, ...] = param(
        (),
        "Extent of the area, east-west and north-south. Left out: 2000 m × 2000 m, or with the "
        "polygons of area as much as they need; where both are given the polygons must lie within.",
        unit="m",
        low=20.0,
        high=50_000.0,
        length=2,
    )
    zero_is_void: bool = param(
        True, "Take heights of exactly 0 for missing data, as many files do. Off at the sea."
    )
    vertical_unit: str = param(
        "",
        "Unit of the heights, where the file names none or one that is not known: us_ft is the US "
        "survey foot. Left out: as the file says.",
        choices=("", "m", "dm", "cm", "mm", "ft", "us_ft"),
    )
    vertical_datum: str = param(
        "",
        "What the heights are measured from, where the file does not say: the ellipsoid, the mean "
        "sea level of its country's maps, or a geoid that models it. Heights above the ellipsoid "
        "are brought to sea level by EGM96, as altitudes of waypoints and missions are above the "
        "sea. Left out: as the file says, else sea level, which is then said.",
        choices=("", "ellipsoid", "sea_level", "EGM84", "EGM96", "EGM2008", "NAVD88", "EVRF2007"),
    )


@dataclass(frozen=True)
class WaypointsPart:
    """Source of the waypoints: computed from the terrain, read from a file, or drawn."""

    source: str = param(
        "coverage",
        "coverage: computed so that the camera sees the whole area; file: read; uniform, gaussian: "
        "drawn at random, for studies.",
        choices=SOURCES,
    )
    file: str = param(
        "",
        "For source file: waypoints or a mission, relative to the scenario file: CSV, GeoJSON, "
        "KML, KMZ, DJI waylines (.kmz), Litchi .csv, QGroundControl .plan, Mission Planner "
        ".waypoints.",
    )
    home_deg: tuple[float, ...] = param(
        (),
        "For source file: latitude and longitude of the take-off place that heights above home "
        "count from, on the ground there. Left out: as the file says.",
        unit="deg",
        low=-180.0,
        high=180.0,
        length=2,
        later=True,
    )
    count: int = param(136, "How many are drawn (uniform, gaussian).", low=1, high=100_000)
    height_m: float = param(
        100.0,
        "Height above ground of drawn waypoints, and of those that a KML lays on the ground.",
        unit="m",
        low=1.0,
        high=5000.0,
    )
    seed: int = param(
        0,
        "Seed of the draw; apart from search.seed, so that several searches face one set.",
        low=0,
        high=2**31 - 1,
    )


@dataclass(frozen=True)
class CameraPart:
    """The camera that every UAV carries."""

    sensor_mm: tuple[float, ...] = param(
        (13.2, 8.8), "Width and height of the sensor.", unit="mm", low=0.5, high=100.0, length=2
    )
    focal_length_mm: float = param(8.8, "Focal length.", unit="mm", low=0.5, high=1000.0)
    image_px: tuple[int, ...] = param(
        (5472, 3648), "Width and height of an image.", unit="px", low=16, high=100_000, length=2
    )
    footprint_m: tuple[float, ...] = param(
        (),
        "Width and height of the ground in one image at coverage.distance_m, instead of "
        "camera.sensor_mm and camera.focal_length_mm.",
        unit="m",
        low=0.1,
        high=5000.0,
        length=2,
    )
    exposure_s: float = param(
        0.001, "Exposure time, for trajectory.photo_blur_px.", unit="s", low=1e-6, high=60.0
    )


@dataclass(frozen=True)
class CoveragePart:
    """How the surface is to be photographed."""

    distance_m: float = param(
        0.0,
        "Distance from the surface along its normal; 0: the distance that gives coverage.gsd_cm.",
        unit="m",
        low=0.0,
        high=2000.0,
    )
    gsd_cm: float = param(
        4.0,
        "Ground sampling distance, size of a pixel on the surface.",
        unit="cm/px",
        low=0.01,
        high=200.0,
    )
    overlap_h: float = param(
        0.3, "Overlap of neighbouring images across, σ_h.", low=0.0, high=1.0, strict=True
    )
    overlap_v: float = param(
        0.3, "Overlap of neighbouring images along, σ_v.", low=0.0, high=1.0, strict=True
    )
    height_min_m: float = param(
        20.0, "Least height above ground of any waypoint.", unit="m", low=0.0, high=2000.0
    )
    clearance_radius_m: float = param(
        30.0,
        "Radius around a waypoint within which coverage.height_min_m holds.",
        unit="m",
        low=0.0,
        high=1000.0,
    )
    pitch_min_deg: float = param(
        -90.0, "Lowest gimbal pitch; -90 is straight down.", unit="deg", low=-90.0, high=90.0
    )
    pitch_max_deg: float = param(
        20.0, "Highest gimbal pitch; 0 is the horizon.", unit="deg", low=-90.0, high=90.0
    )
    trigger: str = param(
        "each",
        "How photographs on straight lines of equal spacing, heading and pitch are triggered: "
        "each: one by one; distance: by the distance flown; time: at equal times. All others are "
        "triggered one by one.",
        choices=("each", "distance", "time"),
        later=True,
    )
    fill_gaps: bool = param(True, "Add waypoints where the regular grid leaves ground unseen.")
    heading_deg: float = param(
        -1.0,
        "Direction of the grid's rows, clockwise from north. -1: along the contour lines of a "
        "rectangle; of polygons, the one that takes the fewest waypoints.",
        unit="deg",
        low=-1.0,
        high=360.0,
    )
    crosshatch: bool = param(False, "Lay a second grid across the first.")
