import math

import numpy as np
import pytest

from jfto_msgs_py.records.plan import Origin, Waypoint
from jfto_planner.coverage import Camera, certify_coverage
from jfto_world.terrain import CubicSurface, Dem

CAMERA = Camera(36.0, 24.0, 24.0, 6000, 4000)


def make_dem(height, size=(400.0, 400.0), margin=100.0, step=5.0):
    half = (size[0] / 2 + margin, size[1] / 2 + margin)
    x, y = (np.arange(-h, h + step / 2, step) for h in half)
    surface = CubicSurface.through(height(*np.meshgrid(x, y)), x[0], y[0], step, step)
    origin = Origin(36.6, -84.2, 500.0)
    return Dem(origin, size, half, surface, "mean sea level", description="")


def flat():
    return make_dem(lambda x, y: 0 * x + 0 * y)


@pytest.mark.parametrize(("yaw_deg", "wide_east"), [(0.0, True), (90.0, False), (180.0, True)])
def test_one_photo_shows_its_footprint(yaw_deg, wide_east):
    """Straight down from 100 m over level ground: 150 × 100 m, the long side across the yaw."""
    found = certify_coverage([Waypoint(7, (0.0, 0.0, 100.0), yaw_deg, -90.0)], flat(), CAMERA)
    assert found.seen_once == pytest.approx(150 * 100 / 400**2, rel=0.03)
    assert found.seen_twice == 0.0
    seen = np.argwhere(found.views > 0)
    height, width = np.ptp(found.y_m[seen[:, 0]]), np.ptp(found.x_m[seen[:, 1]])
    assert (width > height) == wide_east
    assert found.gsd_mean_m == pytest.approx(0.025)
    assert found.gsd_std_m == pytest.approx(0.0, abs=1e-9)
    assert found.surface_m2 == pytest.approx(400**2)


def test_two_photos_overlap():
    """Two photos half a footprint apart see a third of their union twice."""
    photos = [Waypoint(k, (75.0 * k, 0.0, 100.0)) for k in range(2)]
    found = certify_coverage(photos, flat(), CAMERA)
    assert found.seen_twice / found.seen_once == pytest.approx(1 / 3, rel=0.03)


def test_a_wall_hides_what_lies_behind_it():
    """Looking level at a ridge, only its near side is seen."""
    dem = make_dem(lambda x, y: 60 * np.exp(-((y / 25) ** 2)) + 0 * x)
    photo = Waypoint(0, (0.0, -120.0, 30.0), 0.0, 0.0)
    found = certify_coverage([photo], dem, CAMERA)
    seen_y = found.y_m[np.argwhere(found.views > 0)[:, 0]]
    assert seen_y.max() < 5.0
    assert seen_y.min() > -120.0
    assert (found.views > 0).any()


def test_ground_that_turns_away_or_lies_far_is_not_seen():
    """Oblique photos lose what is beyond the incidence limit, and beyond the resolution limit."""
    photo = [Waypoint(0, (0.0, -190.0, 20.0), 0.0, -20.0)]
    loose, strict, sharp = (
        certify_coverage(photo, flat(), CAMERA, **limit).seen_once
        for limit in (
            {"max_incidence_deg": 89.0},
            {"max_incidence_deg": 60.0},
            {"max_incidence_deg": 89.0, "gsd_max_m": CAMERA.gsd_m(100.0)},
        )
    )
    assert loose > sharp > 0
    assert loose > strict > 0


def test_photos_of_nothing_are_named():
    """A camera that looks at the sky, or away from the area, is listed as blind."""
    photos = [
        Waypoint(3, (0.0, 0.0, 50.0), 0.0, 80.0),
        Waypoint(4, (250.0, 0.0, 50.0), 90.0, -20.0),
        Waypoint(5, (0.0, 0.0, 50.0)),
    ]
    assert certify_coverage(photos, flat(), CAMERA).blind == (3, 4)
    nothing = certify_coverage(photos[:1], flat(), CAMERA)
    assert nothing.seen_once == 0.0
    assert math.isnan(nothing.gsd_mean_m)


def test_shares_are_of_the_surface_not_of_the_map():
    """A steep half weighs more than a flat half of equal width on the map."""
    dem = make_dem(lambda x, y: np.where(x > 0, 1.5 * x, 0.0) + 0 * y)
    photos = [Waypoint(k, (-150.0 + 20 * (k % 6), -180.0 + 40 * (k // 6), 60.0)) for k in range(60)]
    found = certify_coverage(photos, dem, CAMERA, max_incidence_deg=40.0)
    flat_half = found.views[:, : len(found.x_m) // 2] > 0
    share_on_map = float((found.views > 0).mean())
    assert flat_half.mean() > 0.8
    assert found.seen_once < share_on_map


def test_more_photos_never_show_less():
    """Adding photos raises both shares or leaves them, and the order does not matter."""
    rng = np.random.default_rng(0)
    dem = make_dem(lambda x, y: 30 * np.sin(x / 40) * np.cos(y / 50))
    photos = [
        Waypoint(
            k, (*map(float, rng.uniform(-180, 180, 2)), float(rng.uniform(60, 120))), 0.0, -80.0
        )
        for k in range(12)
    ]
    few, all_, turned = (
        certify_coverage(chosen, dem, CAMERA) for chosen in (photos[:6], photos, photos[::-1])
    )
    assert few.seen_once <= all_.seen_once
    assert few.seen_twice <= all_.seen_twice
    assert np.array_equal(all_.views, turned.views)
    assert all_.gsd_mean_m == pytest.approx(turned.gsd_mean_m)
