"""The fence of a scenario: no-fly zones and what is to be kept in, in the plan's local frame."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jfto.planning.scenario_file import LoadedScenario
from jfto_msgs_py.errors import SiteError
from jfto_msgs_py.mission_file import PLAN_SUFFIX
from jfto_msgs_py.mission_file.document import CIRCLE_IN, CIRCLE_OUT, FENCE_RETURN, POLYGON_IN
from jfto_msgs_py.mission_file.read import read_document
from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.site import Fence, Polygon, Zone
from jfto_msgs_py.scenario.shape_text import ShapeText, read_shape
from jfto_msgs_py.scenario.trajectory import TrajectoryPart
from jfto_world.terrain import Dem

if TYPE_CHECKING:
    from jfto_world.site import SiteShape

# A circle to stay in becomes a polygon inside of it.
_KEEP_IN_CORNERS = 72
_KINDS = {"keep_out": False, "keep_in": True}
_TAKEN = ("kind", "bottom_m", "top_m", "radius_m")
# What other programs call heights and sizes, of which neither unit nor zero is known.
_UNCLEAR = frozenset(
    ("bottom", "top", "floor", "ceiling", "lower", "upper", "height", "radius", "min_alt",
     "max_alt", "minalt", "maxalt", "lower_limit", "upper_limit", "lowerlimit", "upperlimit")
)  # fmt: skip
_SAMPLE_M = 5.0
# A fence that begins farther from the terrain than this is somebody else's, or mistaken.
_FAR_M = 20_000.0
_DEGREE_M = 111_320.0
# What a vehicle strays from its legs.
_STRAYED_M = 1.0


@dataclass(frozen=True)
class _Shape:
    """One shape as it was given: `place` names it in messages, `holes_deg` are its holes."""

    place: str
    keep_in: bool
    text: ShapeText
    holes_deg: tuple[tuple[tuple[float, float], ...], ...] = ()


def fence_of(loaded: LoadedScenario, dem: Dem) -> tuple[Fence | None, tuple[str, ...]]:
    """Fence of a scenario's `fence` keys over its ground, None without; and notes on its file.

    Raises SiteError that names the key, the shape, the reason and the cure.
    """
    wanted = loaded.scenario.fence
    if not (wanted.file or wanted.keep_out or wanted.keep_in):
        return None, ()
    notes: tuple[str, ...] = ()
    shapes = [
        _Shape(f"fence.{key}[{k}]", key == "keep_in", read_shape(text))
        for key in _KINDS
        for k, text in enumerate(getattr(wanted, key))
    ]
    try:
        if wanted.file:
            found, notes = _of_file(loaded, wanted.file, wanted.layer)
            shapes += found
        for one in shapes:
            _require_near(one, dem)
        keep_in = tuple(_polygon(one, dem) for one in shapes if one.keep_in)
        zones = [
            zone
            for one in shapes
            if not one.keep_in
            for zone in (_zone(one, dem, above_ground=wanted.heights == "ground"),)
        ]
    except SiteError as error:
        raise SiteError(f"{loaded.path}: {error}") from None
    named = tuple(
        replace(zone, name=zone.name or f"zone {k}") for k, zone in enumerate(zones, start=1)
    )
    fence: Fence = Fence(keep_in, named, wanted.margin_m)
    return fence, notes


def _require_near(shape: _Shape, dem: Dem) -> None:
    """Raise SiteError for a shape far from the terrain, which would be kept without a thought."""
    corners = np.array(shape.text.corners_deg)
    away_m = _away_m(corners, shape.text.radius_m, dem)
    if away_m <= _FAR_M:
        return
    at = f"it lies at {corners[0, 0]:.4f}, {corners[0, 1]:.4f}"
    swapped = corners[:, ::-1]
    if np.abs(swapped[:, 0]).max() <= 90 and _away_m(swapped, 0.0, dem) <= _FAR_M:
        raise SiteError(
            f"{shape.place}: its latitude and longitude are exchanged: as given {at}, "
            f"{away_m / 1000:.0f} km from the terrain. Exchange them."
        )
    raise SiteError(
        f"{shape.place}: {at}, {away_m / 1000:.0f} km from the terrain, where it can keep nobody "
        "from anything. Correct its place, or remove it."
    )


def _away_m(corners_deg: np.ndarray, radius_m: float, dem: Dem) -> float:
    """Distance of a shape from the terrain, m; roughly, on a map about its origin."""
    import shapely

    east_deg = (corners_deg[:, 1] - dem.origin.lon_deg + 180.0) % 360.0 - 180.0
    north_deg = corners_deg[:, 0] - dem.origin.lat_deg
    stretch = math.cos(math.radians(dem.origin.lat_deg))
    points = _DEGREE_M * np.column_stack([east_deg * stretch, north_deg])
    shape = shapely.Point(points[0]) if len(points) == 1 else shapely.Polygon(points)
    away_m = float(shapely.make_valid(shape).distance(shapely.Point(0.0, 0.0)))
    return away_m - radius_m - 0.5 * math.hypot(*dem.size_m)


def corner_allowance_m(wanted: TrajectoryPart) -> float:
    """What corners may take of the way round a zone: autopilots cut them, on the way home too."""
    return 0.0 if wanted.mode == "straight" else wanted.wpnav_radius_m + _STRAYED_M


def _of_file(loaded: LoadedScenario, name: str, layer: str) -> tuple[list[_Shape], tuple[str, ...]]:
    path = loaded.resolve(name)
    if path.suffix.lower() == PLAN_SUFFIX:
        document = read_document(path)
        found = list(_of_items(document.fence))
        if not found:
            raise SiteError(
                f"fence.file: {path}: has no fence. Draw one in QGroundControl (GeoFence)."
            )
        return found, ()
    from jfto_world.site import SiteKeys, read_site

    site = read_site(path, layer, SiteKeys("fence.file", "fence.layer"))
    shapes = [one for shape in (*site.shapes, *site.points) for one in _of_shape(shape)]
    return shapes, site.notes


def _of_items(items: Any) -> Iterator[_Shape]:
    """Shapes of a QGroundControl fence."""
    index = 0
    while index < len(items):
        item = items[index]
        place = (item.params[4], item.params[5])
        if item.command in (CIRCLE_IN, CIRCLE_OUT):
            text = ShapeText((place,), item.params[0])
            yield _Shape(f"fence.file: {item.place}", item.command == CIRCLE_IN, text)
        elif item.command != FENCE_RETURN:
            count = int(item.params[0])
            corners = tuple((i.params[4], i.params[5]) for i in items[index : index + count])
            yield _Shape(
                f"fence.file: {item.place}", item.command == POLYGON_IN, ShapeText(corners)
            )
            index += count - 1
        index += 1


def _of_shape(shape: SiteShape) -> Iterator[_Shape]:
    """Shapes of a feature by its properties."""
    place = f"fence.file: {shape.place}"
    given = {str(name).lower(): value for name, value in shape.properties.items()}
    unclear = sorted(name for name in given if name in _UNCLEAR and given[name] not in (None, ""))
    if unclear:
        raise SiteError(
            f"{place}: has the property {unclear[0]!r}, of which neither unit nor zero is known. "
            f"Name it {' or '.join(_TAKEN[1:])}, in metres (fence.heights says above what), or "
            "remove it."
        )
    kind = str(given.get("kind") or "keep_out").strip().lower()
    if kind not in _KINDS:
        raise SiteError(f"{place}: its kind is {kind!r}, must be keep_out or keep_in.")
    bottom_m, top_m, radius_m = (_number(given, name, place) for name in _TAKEN[1:])
    if bottom_m is not None and top_m is not None and bottom_m >= top_m:
        raise SiteError(f"{place}: bottom_m is not below top_m. Exchange them.")
    if _KINDS[kind] and (bottom_m, top_m) != (None, None):
        raise SiteError(
            f"{place}: what is to be kept in has no heights. Remove bottom_m and top_m."
        )
    if shape.point_deg is not None:
        if not radius_m or radius_m <= 0:
            raise SiteError(
                f"{place}: is a point without radius_m. Give its radius in metres, or draw a "
                "polygon."
            )
        text = ShapeText((shape.point_deg,), radius_m, bottom_m, top_m, shape.name)
        yield _Shape(place, _KINDS[kind], text)
    for number, part in enumerate(shape.polygons, start=1):
        name = shape.name + (f" {number}" if shape.name and len(shape.polygons) > 1 else "")
        text = ShapeText(part.outer_deg, 0.0, bottom_m, top_m, name)
        yield _Shape(place, _KINDS[kind], text, part.holes_deg)


def _number(given: Mapping[str, Any], name: str, place: str) -> float | None:
    value = given.get(name)
    if value is None or value == "":
        return None
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise SiteError(f"{place}: its {name} is {value!r}, must be a number of metres.")
    return number


def _ring(corners: tuple[tuple[float, float], ...], dem: Dem) -> tuple[tuple[float, float], ...]:
    lat, lon = np.array(corners).T
    places = dem.to_enu(lat, lon, np.full(len(lat), dem.origin.alt_m))
    return tuple((float(x), float(y)) for x, y in rounded_record(places[:, :2]))


def _checked(one: _Shape) -> _Shape:
    """The shape, once its outline is seen not to cross itself. Raises SiteError."""
    if not one.text.radius_m:
        from jfto_world.site import ring_polygon

        ring_polygon(one.text.corners_deg, one.place)
    return one


def _polygon(one: _Shape, dem: Dem) -> Polygon:
    """What is to be kept in; a circle becomes a polygon within it."""
    text = _checked(one).text
    if text.radius_m:
        ((east, north),) = _ring(text.corners_deg, dem)
        turns = np.arange(_KEEP_IN_CORNERS) * 2 * np.pi / _KEEP_IN_CORNERS
        ring = np.column_stack([np.cos(turns), np.sin(turns)]) * text.radius_m + (east, north)
        return Polygon(tuple((float(x), float(y)) for x, y in rounded_record(ring)))
    return Polygon(_ring(text.corners_deg, dem), tuple(_ring(h, dem) for h in one.holes_deg))


def _zone(one: _Shape, dem: Dem, *, above_ground: bool) -> Zone:
    text = _checked(one).text
    if one.holes_deg:
        raise SiteError(
            f"{one.place}: a no-fly zone has a hole, which would have to be flown into. Draw it "
            "without."
        )
    corners = _ring(text.corners_deg, dem)
    low = high = -dem.origin.alt_m
    if above_ground and (text.bottom_m, text.top_m) != (None, None):
        low, high = _ground(one.place, np.array(corners), text.radius_m, dem)
    return Zone(
        text.name,
        () if text.radius_m else corners,
        corners[0] if text.radius_m else (0.0, 0.0),
        text.radius_m,
        None if text.bottom_m is None else rounded_record(low + text.bottom_m),
        None if text.top_m is None else rounded_record(high + text.top_m),
    )


def _ground(place: str, corners: Any, radius_m: float, dem: Dem) -> tuple[float, float]:
    """Lowest and highest ground in the box of a zone, of what of it is known."""
    low, high = corners.min(axis=0) - radius_m, corners.max(axis=0) + radius_m
    sides = [
        np.linspace(low[k], high[k], min(400, max(3, int((high[k] - low[k]) / _SAMPLE_M))))
        for k in (0, 1)
    ]
    east, north = (axis.ravel() for axis in np.meshgrid(*sides))
    known = dem.contains(east, north)
    if not known.any():
        raise SiteError(
            f"{place}: lies outside of the terrain, so that its heights above ground are not "
            "known. Give them above sea level (fence.heights sea_level), or remove them."
        )
    ground = dem.height(east[known], north[known])
    return float(ground.min()), float(ground.max())
