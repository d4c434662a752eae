import numpy as np
import pytest

from jfto_msgs_py.errors import TerrainError
from jfto_world.terrain import load_dem


@pytest.fixture(scope="module")
def dem():
    return load_dem("jacksboro", center=(36.6301, -84.2626), size_m=(2000, 1000), margin_m=300)


def test_the_margin_is_known_and_nothing_beyond_it(dem):
    """Height is given up to size / 2 + margin; beyond, a TerrainError names point and cure."""
    assert np.isfinite(dem.height([-1300.0, 1300.0], [-800.0, 800.0])).all()
    assert dem.contains([1299.0, 1301.0], [0.0, 0.0]).tolist() == [True, False]
    with pytest.raises(TerrainError, match=r"x = 1301\.0 m.*margin_m"):
        dem.height([0.0, 1301.0], [0.0, 0.0])
    with pytest.raises(TerrainError, match="nan"):
        dem.height(np.nan, 0.0)


def test_normals_are_unit_and_stand_on_the_ground(dem):
    """The normal is orthogonal to steps along the surface and points up."""
    x, y = np.random.default_rng(0).uniform(-450, 450, (2, 300))
    normal = dem.normal(x, y)
    assert np.linalg.norm(normal, axis=-1) == pytest.approx(1.0)
    assert (normal[:, 2] > 0).all()
    step = 0.01
    for dx, dy in ((step, 0.0), (0.0, step)):
        rise = dem.height(x + dx, y + dy) - dem.height(x - dx, y - dy)
        along = np.stack([np.full(300, 2 * dx), np.full(300, 2 * dy), rise], axis=-1)
        assert np.einsum("ij,ij->i", normal, along) == pytest.approx(0.0, abs=1e-5)


def test_grid_is_the_ground_itself(dem):
    """The drawing grid spans area and margin, and its heights are height()."""
    x, y, z = dem.grid()
    assert z.shape == (len(y), len(x))
    assert (x[0], x[-1], y[0], y[-1]) == pytest.approx((-1300, 1300, -800, 800))
    assert z[10, 20] == pytest.approx(float(dem.height(x[20], y[10])))


def test_rays_and_sight_agree(dem):
    """A point on the ground is seen from where no ray is stopped before it."""
    eye = np.array([0.0, 0.0, float(dem.height(0.0, 0.0)) + 60.0])
    x, y = np.random.default_rng(1).uniform(-450, 450, (2, 500))
    ground = np.column_stack([x, y, dem.height(x, y)])
    distance = np.linalg.norm(ground - eye, axis=1)
    hit = dem.first_hit(eye, ground - eye)
    assert np.array_equal(dem.sees(eye, ground), hit >= distance - 0.1)
    assert 0 < dem.sees(eye, ground).sum() < 500
    assert (hit <= distance + 1e-3).all()


def test_rays_without_a_direction_are_refused(dem):
    """A zero or infinite direction raises."""
    for direction in ((0.0, 0.0, 0.0), (np.nan, 0.0, 1.0)):
        with pytest.raises(TerrainError, match="direction"):
            dem.first_hit((0.0, 0.0, 0.0), direction)


def test_scalars_in_scalars_out(dem):
    """A single point gives a height without axes and a normal of shape (3,)."""
    assert dem.height(1.0, 2.0).shape == ()
    assert dem.normal(1.0, 2.0).shape == (3,)
    assert dem.height([[1.0], [2.0]], [3.0, 4.0]).shape == (2, 2)
