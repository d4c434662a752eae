"""Coverage of polygons: holes, several parts, any outline, rows in any direction."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.plan import Origin, Waypoint
from jfto_planner.coverage import (
    Camera,
    CoverageSettings,
    certify_coverage,
    measure_overlaps,
    plan_coverage,
    random_waypoints,
)
from jfto_world.site import SiteArea, of_shapely, read_site
from jfto_world.terrain import CubicSurface, Dem, load_dem

CAMERA = Camera(17.3, 13.0, 32.0, 5280, 3956)
WISH = CoverageSettings(distance_m=130.0, min_height_m=30.0)
REPOSITORY = Path(__file__).parents[3]
FREE_M2 = 0.49 * math.prod(CAMERA.footprint_m(130.0))


def ground(height, area, size=(800.0, 800.0), step=20.0):
    half = tuple(side / 2 + 300 for side in size)
    x, y = (np.arange(-h, h + step / 2, step) for h in half)
    surface = CubicSurface.through(height(*np.meshgrid(x, y)), x[0], y[0], step, step)
    origin = Origin(36.6, -84.2, 500.0)
    return Dem(origin, size, half, surface, "mean sea level", "", area=of_shapely(area))


def hills(x, y):
    return 40 * np.sin(x / 130) * np.cos(y / 170) + 0.15 * y


def flat(x, y):
    return 0 * x


def allowance(shape):
    """Photos beyond area ÷ free footprint: half a photo's side all along the outline."""
    return shape.length * math.sqrt(FREE_M2) / 2 / FREE_M2


def photo_frame(waypoint, distance_m=130.0):
    """Where the image's corners meet a plane at the distance, seen from above."""
    width, height = (side / 2 for side in CAMERA.footprint_m(distance_m))
    return math.hypot(width, height)


@st.composite
def star(draw, centre=(0.0, 0.0), reach=(60.0, 320.0)):
    """A ring around a centre with corners at random distances: any outline that does not cross."""
    count = draw(st.integers(3, 14))
    radii = [draw(st.floats(*reach)) for _ in range(count)]
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False) + draw(st.floats(0, 6.28))
    return shapely.Polygon(
        [
            (centre[0] + r * np.cos(a), centre[1] + r * np.sin(a))
            for r, a in zip(radii, angles, strict=True)
        ]
    )


@st.composite
def areas(draw):
    """Stars, some with a hole, some in two parts."""
    kind = draw(st.sampled_from(["one", "hole", "two"]))
    if kind == "two":
        parts = [draw(star((-200.0, 0.0), (30.0, 120.0))), draw(star((200.0, 0.0), (30.0, 120.0)))]
        return shapely.MultiPolygon(parts)
    outer = draw(star())
    if kind == "hole":
        outer = outer.difference(draw(star(reach=(10.0, 55.0))))
    return shapely.MultiPolygon([outer]) if outer.geom_type == "Polygon" else outer


@settings(max_examples=15, deadline=None)
@given(area=areas(), rough=st.booleans(), heading=st.sampled_from([None, 0.0, 33.0, 90.0]))
@pytest.mark.slow
def test_any_area_is_seen_or_said_to_be_infeasible(area, rough, heading):
    """≥ 99 % of the area itself is seen, every photo shows some of it, none is far from it."""
    dem = ground(hills if rough else flat, area)
    found = plan_coverage(dem, CAMERA, replace(WISH, heading_deg=heading))
    assert found.certificate.seen_once >= 0.99
    again = certify_coverage(found.waypoints, dem, CAMERA, gsd_max_m=2 * CAMERA.gsd_m(130.0))
    assert again.blind == ()
    assert [w.id for w in found.waypoints] == list(range(len(found.waypoints)))
    reach = 130.0 * 1.5 + photo_frame(found.waypoints[0], 130.0 * 1.5)
    for waypoint in found.waypoints:
        assert area.distance(shapely.Point(waypoint.position_m[:2])) <= reach


@settings(max_examples=10, deadline=None)
@given(area=areas(), heading=st.floats(0, 360))
@pytest.mark.slow
def test_flat_ground_takes_no_more_photos_than_the_outline_asks(area, heading):
    """Waypoints ≤ 1.10 × (area ÷ free footprint + half a photo along the outline), any heading."""
    dem = ground(flat, area)
    found = plan_coverage(dem, CAMERA, replace(WISH, heading_deg=heading, fill_gaps=False))
    assert found.certificate.seen_once >= 0.99
    assert len(found.waypoints) <= 1.10 * (area.area / FREE_M2 + allowance(area)) + 2
    best = plan_coverage(dem, CAMERA, replace(WISH, fill_gaps=False))
    assert len(best.waypoints) <= len(found.waypoints) + best.overlaps.below


AREAS = {
    "hole": REPOSITORY / "config/wanghai_area.geojson",
    "U": REPOSITORY / "test/data/area/u_shape.geojson",
    "two": REPOSITORY / "test/data/area/two_parts.geojson",
}


@pytest.mark.slow
@pytest.mark.parametrize("name", AREAS)
def test_wanghai_as_polygons(name):
    """A hole, a U, two parts at Wanghai: ≥ 99 % seen, few photos, most pairs overlap as asked."""
    shapes = read_site(AREAS[name]).shapes
    area = SiteArea(name, tuple(p for shape in shapes for p in shape.polygons))
    dem = load_dem("jacksboro", center=area.middle_deg, size_m=area.window_m(area.middle_deg))
    dem = replace(dem, area=area.local(dem.frame))
    found = plan_coverage(dem, CAMERA, WISH)
    assert found.certificate.seen_once >= 0.99
    expected = found.certificate.surface_m2 / FREE_M2 + allowance(dem.area_shape)
    assert len(found.waypoints) <= 1.10 * expected
    pairs = found.overlaps.across.pairs + found.overlaps.along.pairs
    assert found.overlaps.below <= 0.15 * pairs
    assert certify_coverage(found.waypoints, dem, CAMERA).seen_once >= 0.99


def test_only_the_area_counts():
    """Photos over one of two parts show half of the area, whatever lies between."""
    west, east = shapely.box(-350, -30, -290, 30), shapely.box(290, -30, 350, 30)
    dem = ground(flat, shapely.MultiPolygon([west, east]))
    photos = [Waypoint(k, (x, y, 130.0)) for k, (x, y) in enumerate([(-335, 0), (-305, 0), (0, 0)])]
    found = certify_coverage(photos, dem, CAMERA)
    assert found.seen_once == pytest.approx(0.5 * 2 * 26.4 / 60, abs=0.02)
    assert found.blind == (2,)
    assert found.surface_m2 == pytest.approx(7200, rel=0.03)


@pytest.mark.slow
def test_a_hole_gets_no_photo_of_its_own():
    """Where the hole is as large as photos, none looks into its middle."""
    hole = shapely.box(-150, -150, 150, 150)
    area = shapely.box(-300, -300, 300, 300).difference(hole)
    found = plan_coverage(ground(flat, area), CAMERA, WISH)
    middle = shapely.box(-90, -90, 90, 90)
    assert not any(middle.contains(shapely.Point(w.position_m[:2])) for w in found.waypoints)


@pytest.mark.slow
def test_rows_follow_a_tilted_strip_and_a_wished_heading():
    """Level ground: rows run along a strip that lies at 30°; coverage.heading_deg overrules."""
    strip = shapely.affinity.rotate(shapely.box(-350, -18, 350, 18), 60, origin=(0, 0))
    dem = ground(flat, strip)
    found = plan_coverage(dem, CAMERA, WISH)
    assert found.heading_deg == pytest.approx(30.0, abs=1.0)
    assert len(found.waypoints) == math.ceil(700 / (0.7 * CAMERA.footprint_m(130.0)[0]))
    # The image's long side lies along the rows, its upper edge across.
    assert all(w.yaw_deg % 180 == pytest.approx(120.0, abs=1.0) for w in found.waypoints)
    across = plan_coverage(dem, CAMERA, replace(WISH, heading_deg=120.0))
    assert across.heading_deg == 120.0
    assert len(across.waypoints) > len(found.waypoints)


@pytest.mark.slow
def test_a_second_grid_lies_across_the_first():
    """With crosshatch level ground is photographed twice, images turned by 90°."""
    dem = ground(flat, shapely.box(-150, -150, 150, 150))
    one = plan_coverage(dem, CAMERA, WISH)
    two = plan_coverage(dem, CAMERA, replace(WISH, crosshatch=True))
    assert two.waypoints[: len(one.waypoints)] == one.waypoints
    more = two.waypoints[len(one.waypoints) :]
    assert len(more) == pytest.approx(len(one.waypoints), rel=0.2)
    turned = {(w.yaw_deg - one.waypoints[0].yaw_deg) % 180 for w in more}
    assert turned == {90.0}
    assert two.certificate.seen_twice == 1.0


def test_too_many_photos_are_infeasible_with_a_cure():
    """An area of more photos than are allowed is refused before anything is placed."""
    dem = ground(flat, shapely.box(-400, -400, 400, 400))
    with pytest.raises(InfeasibleError, match="more than 20 waypoints") as caught:
        plan_coverage(dem, CAMERA, replace(WISH, max_waypoints=20))
    assert "a smaller area (terrain.size_m, area.file)" in caught.value.cures


@pytest.mark.parametrize("kind", ["uniform", "gaussian"])
def test_random_waypoints_lie_in_the_area(kind):
    """Drawn waypoints fall into the polygons, in both parts, never into the hole."""
    ring = shapely.box(-300, -200, -20, 200).difference(shapely.box(-200, -50, -100, 50))
    area = shapely.MultiPolygon([ring, shapely.box(20, -200, 300, 200)])
    dem = ground(flat, area)
    found = random_waypoints(kind, 300, dem, 100.0, np.random.default_rng(3))
    points = shapely.points([w.position_m[:2] for w in found])
    assert shapely.within(points, area).all()
    assert {shapely.within(points, part).any() for part in area.geoms} == {True}
    again = random_waypoints(kind, 300, dem, 100.0, np.random.default_rng(3))
    assert again == found


@pytest.mark.parametrize(
    ("shift", "expected"), [((30.0, 0.0), (0.573, None)), ((0.0, 40.0), (None, 0.243))]
)
def test_overlap_of_a_pair_is_the_share_of_its_lines(shift, expected):
    """Over level ground two photos overlap by 1 - shift ÷ footprint, to a line's 41 points."""
    dem = ground(flat, shapely.box(-300, -300, 300, 300))
    photos = [Waypoint(0, (0.0, 0.0, 130.0)), Waypoint(4, (*shift, 130.0))]
    found = measure_overlaps(photos, dem, CAMERA, (0.3, 0.3))
    for pairs, share in zip((found.across, found.along), expected, strict=True):
        assert pairs.pairs == (share is not None)
        if share is not None:
            assert pairs.least == pairs.p05 == pytest.approx(share, abs=1 / 40)
            assert pairs.below == (share < 0.3 - 1 / 40)
            assert pairs.worst == (0, 4)


def test_photos_on_either_side_of_a_hole_are_no_pair():
    """Nothing has to overlap where there is nothing to see; nor with a third photo between."""
    area = shapely.MultiPolygon([shapely.box(-80, -30, -20, 30), shapely.box(20, -30, 80, 30)])
    photos = [Waypoint(0, (-50.0, 0.0, 130.0)), Waypoint(1, (50.0, 0.0, 130.0))]
    assert measure_overlaps(photos, ground(flat, area), CAMERA, (0.3, 0.3)).across.pairs == 0
    whole = ground(flat, shapely.box(-80, -30, 80, 30))
    assert measure_overlaps(photos, whole, CAMERA, (0.3, 0.3)).across.least == 0.0
    photos.append(Waypoint(2, (0.0, 0.0, 130.0)))
    found = measure_overlaps(photos, whole, CAMERA, (0.3, 0.3)).across
    assert (found.pairs, found.least > 0.2) == (2, True)


def test_places_that_are_only_passed_take_no_photo():
    """A waypoint without a photo shows nothing and is nobody's neighbour."""
    dem = ground(flat, shapely.box(-30, -20, 30, 20))
    passed = Waypoint(0, (0.0, 0.0, 130.0), photo=False)
    assert certify_coverage([passed], dem, CAMERA).seen_once == 0.0
    assert measure_overlaps([passed, replace(passed, id=1)], dem, CAMERA, (0.3, 0.3)).below == 0


@pytest.mark.slow
def test_the_area_of_a_rectangle_is_the_rectangle():
    """A rectangle given as a polygon is seen by about as many photos as the short form."""
    box = shapely.box(-200, -150, 200, 150)
    polygon = plan_coverage(ground(flat, box), CAMERA, WISH)
    dem = replace(ground(flat, box), area=(), size_m=(400.0, 300.0))
    assert dem.in_area([0.0, 201.0], [0.0, 0.0]).tolist() == [True, False]
    short = plan_coverage(dem, CAMERA, WISH)
    assert len(polygon.waypoints) <= len(short.waypoints)
