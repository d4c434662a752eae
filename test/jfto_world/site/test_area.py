"""The area in its local frame: joined, widened, and on the terrain or refused with where it is."""

import numpy as np
import pytest
import shapely

from jfto_msgs_py.errors import SiteError
from jfto_msgs_py.records.plan import Origin
from jfto_world.site import GeoPolygon, SiteArea, as_shapely, of_shapely, polygon_area
from jfto_world.terrain import LocalFrame
from jfto_world.terrain.load import open_layers

LAT, LON = 36.6255, -84.2650
FRAME = LocalFrame(Origin(LAT, LON, 700.0))
TERRAIN = open_layers("jacksboro")


def at(*corners, lat=LAT, lon=LON):
    """Polygon of corners in metres east and north of a place."""
    frame = LocalFrame(Origin(lat, lon, 700.0))
    found = [frame.to_geodetic((x, y, 0.0)) for x, y in corners]
    return GeoPolygon(tuple((float(a), float(b)) for a, b, _ in found))


def square(half, x=0.0, y=0.0, **place):
    return at(
        (x - half, y - half),
        (x + half, y - half),
        (x + half, y + half),
        (x - half, y + half),
        **place,
    )


def test_corners_come_back_in_metres():
    """Edges are straight in the frame and corners where they were drawn, to a millimetre."""
    (part,) = SiteArea("a", (square(200.0),)).local(FRAME)
    assert np.sort(np.abs(part.outer).ravel()) == pytest.approx(np.full(8, 200.0), abs=1e-3)


def test_overlapping_parts_are_joined_and_apart_stay_apart():
    """What lies in two polygons is surveyed once."""
    joined = SiteArea("a", (square(100.0), square(100.0, x=150.0))).local(FRAME)
    assert as_shapely(joined).area == pytest.approx(350 * 200, rel=1e-4)
    assert len(joined) == 1
    assert len(SiteArea("a", (square(100.0), square(100.0, x=300.0))).local(FRAME)) == 2


def test_the_buffer_widens_and_narrows():
    """area.buffer_m goes all around, corners rounded; what it leaves nothing of is refused."""
    wide = as_shapely(SiteArea("a", (square(100.0),), 20.0).local(FRAME))
    assert wide.area == pytest.approx(40_000 + 4 * 200 * 20 + np.pi * 400, rel=1e-2)
    narrow = as_shapely(SiteArea("a", (square(100.0),), -20.0).local(FRAME))
    assert narrow.area == pytest.approx(160 * 160, rel=1e-4)
    with pytest.raises(SiteError, match=r"nothing is left .*buffer_m -120.*another area.buffer_m"):
        SiteArea("a", (square(100.0),), -120.0).local(FRAME)


def test_areas_too_small_and_too_large_are_refused():
    """3 m² and 3000 km² are slips of the unit."""
    with pytest.raises(SiteError, match=r"3\.0 m² large, less than one photo"):
        SiteArea("f.kml", (square(3**0.5 / 2),)).local(FRAME)
    with pytest.raises(SiteError, match="3000 km² large, more than any fleet"):
        SiteArea("f.kml", (square(27_386.0),)).local(FRAME)


def test_the_window_holds_the_area_about_any_centre():
    """Centre of the bounds, and the extent that a frame at any height needs around it."""
    area = SiteArea("a", (square(100.0, x=50.0), square(100.0, x=450.0)))
    lat, lon = area.middle_deg
    assert (lat, lon) == pytest.approx(
        (LAT, LON + 250 / 111_320 / np.cos(np.radians(LAT))), abs=1e-4
    )
    assert area.window_m((lat, lon)) == pytest.approx((600, 200), rel=3e-3)
    assert area.window_m((LAT, LON)) == pytest.approx((1100, 200), rel=3e-3)


def test_an_area_across_the_date_line_is_one():
    """Cut at 180° as RFC 7946 asks, both halves lie beside one another in the frame."""
    west, east = square(500.0, lon=179.995), square(500.0, lon=-179.996)
    area = SiteArea("a", (west, east))
    assert abs(area.middle_deg[1]) == pytest.approx(179.9995, abs=1e-3)
    assert area.window_m(area.middle_deg)[0] == pytest.approx(1802, rel=0.02)


@pytest.mark.parametrize(
    ("area", "words"),
    [
        ((square(100.0),), None),
        (
            (square(2000.0, lat=36.7325),),
            r"\d+ % of it, its north(-west|-east)? part, lies outside",
        ),
        ((square(100.0, lat=LON, lon=LAT),), "latitude and longitude are exchanged"),
        ((square(100.0, lat=46.2, lon=7.6),), r"lies at 46.2000, 7.6000, outside .*terrain.source"),
    ],
)
def test_it_must_lie_on_the_terrain(area, words):
    """Partly outside: the share and where. Exchanged coordinates are told from another country."""
    area = SiteArea("area.file f.kml", area)
    if words is None:
        area.require_on(TERRAIN)
        return
    with pytest.raises(SiteError, match=words) as caught:
        area.require_on(TERRAIN)
    assert str(caught.value).startswith("area.file f.kml: ")


def test_corners_in_the_scenario_make_a_polygon():
    """area.polygon_deg: latitude and longitude in turn, closed or not, never crossing itself."""
    ring = [36.62, -84.27, 36.62, -84.26, 36.63, -84.26]
    assert polygon_area(ring, 0.0).polygons == polygon_area([*ring, *ring[:2]], 0.0).polygons
    with pytest.raises(
        SiteError, match=r"area.polygon_deg: its outline crosses itself near 36.625"
    ):
        polygon_area([36.62, -84.27, 36.63, -84.26, 36.62, -84.26, 36.63, -84.27], 0.0)
    with pytest.raises(SiteError, match="2 different corners, an area needs 3"):
        polygon_area([36.62, -84.27, 36.63, -84.26, 36.62, -84.27], 0.0)


def test_records_and_shapely_agree():
    """To shapely and back: the same rings, from west to east."""
    hole = shapely.box(-10, -10, 10, 10)
    shape = shapely.MultiPolygon([shapely.box(50, 0, 60, 9), shapely.box(-30, -30, 30, 30) - hole])
    parts = of_shapely(shape)
    assert [len(part.holes) for part in parts] == [1, 0]
    assert as_shapely(parts).equals(shape)
