import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_world.terrain import CubicSurface
from jfto_world.terrain.cubic_surface import cell_ceilings, first_hit

INF = np.inf


def cast(surface, origin, direction, max_range=1e5):
    origin, direction = np.atleast_2d(origin).astype(float), np.atleast_2d(direction).astype(float)
    unit = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    reach = np.full(len(origin), max_range)
    return first_hit(surface, cell_ceilings(surface), origin, unit, reach)


def plane(east=0.3, north=-0.1, level=5.0):
    y, x = np.mgrid[0:40, 0:50] * 25.0
    return CubicSurface.through(east * x + north * y + level, 0.0, 0.0, 25.0, 25.0)


def test_rays_meet_a_plane_where_geometry_says():
    """Distances to a tilted plane are exact, and rays that leave its sides hit nothing."""
    rng = np.random.default_rng(0)
    origin = np.column_stack([rng.uniform(0, 1225, 20000), rng.uniform(0, 975, 20000)])
    origin = np.column_stack([origin, rng.uniform(400, 900, 20000)])
    direction = rng.normal(size=(20000, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    gap = origin[:, 2] - (0.3 * origin[:, 0] - 0.1 * origin[:, 1] + 5)
    closing = -(direction[:, 2] - 0.3 * direction[:, 0] + 0.1 * direction[:, 1])
    with np.errstate(divide="ignore"):
        expected = np.where(closing > 0, gap / closing, INF)
    end = origin + direction * np.where(np.isfinite(expected), expected, 0)[:, None]
    on_grid = (end[:, 0] >= 0) & (end[:, 0] <= 1225) & (end[:, 1] >= 0) & (end[:, 1] <= 975)
    expected = np.where(on_grid, expected, INF)
    found = cast(plane(), origin, direction)
    assert np.array_equal(np.isfinite(found), np.isfinite(expected))
    hit = np.isfinite(found)
    assert hit.sum() > 1000
    # Where a ray nearly runs along the plane the distance is ill-conditioned, the height is not.
    assert (found[hit] - expected[hit]) * closing[hit] == pytest.approx(0.0, abs=1e-5)


def test_rays_meet_a_sphere_cap_where_geometry_says():
    """A cap of radius 2 km, sampled every 10 m, is hit within a millimetre."""
    radius = 2000.0
    axis = np.linspace(-500, 500, 101)
    x, y = np.meshgrid(axis, axis)
    surface = CubicSurface.through(
        np.sqrt(radius**2 - x**2 - y**2) - radius, -500.0, -500.0, 10.0, 10.0
    )
    rng = np.random.default_rng(1)
    target = np.column_stack([rng.uniform(-300, 300, (500, 2)), np.zeros(500)])
    target[:, 2] = np.sqrt(radius**2 - (target[:, :2] ** 2).sum(axis=1)) - radius
    origin = np.column_stack([rng.uniform(-450, 450, (500, 2)), rng.uniform(1, 200, 500)])
    direction = target - origin
    unit = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    centre = np.array([0.0, 0.0, -radius])
    along = ((origin - centre) * unit).sum(axis=1)
    root = along**2 - (((origin - centre) ** 2).sum(axis=1) - radius**2)
    expected = -along - np.sqrt(root)
    assert cast(surface, origin, direction) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("height_m", [1e-3, 0.1, 1.0])
def test_a_ray_that_passes_just_over_a_ridge_goes_on_and_one_just_under_it_does_not(height_m):
    """Grazing rays are decided right to a millimetre, whatever their angle to the ridge."""
    axis = np.linspace(-500, 500, 101)
    x, _ = np.meshgrid(axis, axis)
    surface = CubicSurface.through(100 * np.exp(-((x / 80) ** 2)), -500.0, -500.0, 10.0, 10.0)
    top = float(surface.height_and_gradient(np.zeros(1), np.zeros(1))[0][0])
    for bearing in np.radians([90.0, 63.0, 17.3, 120.0]):
        unit = np.array([np.sin(bearing), np.cos(bearing), 0.0])
        start = -400 * unit
        assert cast(surface, start + np.array([0, 0, top + height_m]), unit)[0] == INF
        assert np.isfinite(cast(surface, start + np.array([0, 0, top - height_m]), unit)[0])


@pytest.mark.slow
@settings(deadline=None, derandomize=True, max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_nothing_on_the_way_to_a_hit_is_below_ground(seed):
    """On rough ground: all of a ray before its hit is above the surface, the hit is on it."""
    rng = np.random.default_rng(seed)
    heights = rng.normal(size=(12, 12)) * rng.uniform(1, 60)
    surface = CubicSurface.through(heights, 0.0, 0.0, 20.0, 20.0)
    origin = np.column_stack([rng.uniform(0, 220, (20, 2)), np.zeros(20)])
    ground = surface.height_and_gradient(origin[:, 0], origin[:, 1])[0]
    origin[:, 2] = ground + rng.uniform(0.01, 80, 20)
    direction = rng.normal(size=(20, 3)) * [1, 1, 0.3]
    unit = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    found = cast(surface, origin, unit, 1000.0)
    for start, along, distance in zip(origin, unit, found, strict=True):
        reach = min(distance, 1000.0)
        t = np.linspace(0, reach * (1 - 1e-9), 2000)
        points = start + t[:, None] * along
        inside = surface.contains(points[:, 0], points[:, 1])
        gap = points[:, 2] - surface.height_and_gradient(points[:, 0], points[:, 1])[0]
        assert (gap[inside] > -1e-5).all()
        if np.isfinite(distance):
            end = start + distance * along
            here = surface.height_and_gradient(end[:1], end[1:2])[0][0]
            assert end[2] == pytest.approx(here, abs=1e-3)


def test_vertical_and_axis_parallel_rays():
    """Rays along an axis or on a line of the grid are no special case."""
    surface = plane(0.0, 0.0, 10.0)
    assert cast(surface, [50.0, 75.0, 60.0], [0, 0, -1])[0] == pytest.approx(50.0)
    assert cast(surface, [50.0, 75.0, 60.0], [0, 0, 1])[0] == INF
    assert cast(surface, [0.0, 75.0, 60.0], [1, 0, -1])[0] == pytest.approx(50 * np.sqrt(2))
    assert cast(surface, [50.0, 975.0, 60.0], [0, -1, -1])[0] == pytest.approx(50 * np.sqrt(2))


def test_ranges_starts_below_ground_and_starts_outside():
    """Beyond max range nothing is hit; from below ground at 0; from outside, once over the grid."""
    surface = plane(0.0, 0.0, 10.0)
    assert cast(surface, [50.0, 75.0, 60.0], [0, 0, -1], 49.9)[0] == INF
    assert cast(surface, [50.0, 75.0, 5.0], [0, 0, 1])[0] == 0.0
    assert cast(surface, [-30.0, 75.0, 60.0], [1, 0, -1])[0] == pytest.approx(50 * np.sqrt(2))
    assert cast(surface, [-30.0, 75.0, 60.0], [-1, 0, -1])[0] == INF
