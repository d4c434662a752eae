import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_world.terrain import CubicSurface


def grid(rows, columns, step=25.0):
    y, x = np.mgrid[0:rows, 0:columns] * step
    return x, y


def test_surface_passes_through_its_nodes():
    """At every node the surface has the height it was given."""
    heights = np.random.default_rng(1).normal(size=(17, 23)) * 50
    x, y = grid(17, 23)
    surface = CubicSurface.through(heights, 0.0, 0.0, 25.0, 25.0)
    assert surface.height_and_gradient(x, y)[0] == pytest.approx(heights, abs=1e-9)


@settings(deadline=None, derandomize=True, max_examples=30)
@given(st.floats(-2, 2), st.floats(-2, 2), st.integers(2, 40), st.integers(2, 40))
def test_planes_are_reproduced_up_to_the_edge(east, north, rows, columns):
    """A plane comes back with its heights and slopes, also in cells at the edge."""
    x, y = grid(rows, columns)
    surface = CubicSurface.through(east * x + north * y + 7, 0.0, 0.0, 25.0, 25.0)
    rng = np.random.default_rng(0)
    px, py = rng.uniform(0, x.max(), 50), rng.uniform(0, y.max(), 50)
    height, slope_east, slope_north = surface.height_and_gradient(px, py)
    assert height == pytest.approx(east * px + north * py + 7, abs=1e-8)
    assert slope_east == pytest.approx(east, abs=1e-9)
    assert slope_north == pytest.approx(north, abs=1e-9)


def test_smooth_ground_is_met_between_nodes_to_fourth_order():
    """Halving the spacing divides the error at least by 12 (bicubic: 16)."""

    def worst(step):
        count = int(1000 / step) + 1
        x, y = grid(count, count, step)
        surface = CubicSurface.through(
            np.sin(x / 100) * np.cos(y / 130) * 100, 0.0, 0.0, step, step
        )
        rng = np.random.default_rng(0)
        px, py = rng.uniform(300, 700, (2, 2000))
        return np.abs(
            surface.height_and_gradient(px, py)[0] - np.sin(px / 100) * np.cos(py / 130) * 100
        ).max()

    assert worst(20.0) > 12 * worst(10.0)


def test_slopes_are_the_derivatives_of_the_height():
    """Slopes equal central differences, also with steps that run backwards."""
    heights = np.random.default_rng(2).normal(size=(12, 15)) * 10
    surface = CubicSurface.through(heights, 100.0, 900.0, 20.0, -30.0)
    rng = np.random.default_rng(3)
    x, y = rng.uniform(120, 360, 200), rng.uniform(600, 880, 200)
    _, east, north = surface.height_and_gradient(x, y)
    step = 1e-4

    def height(px, py):
        return surface.height_and_gradient(px, py)[0]

    difference_east = (height(x + step, y) - height(x - step, y)) / (2 * step)
    difference_north = (height(x, y + step) - height(x, y - step)) / (2 * step)
    assert east == pytest.approx(difference_east, abs=1e-6)
    assert north == pytest.approx(difference_north, abs=1e-6)


def test_transposed_surface_exchanges_the_axes():
    """transposed() has at (y, x) the height of (x, y)."""
    heights = np.random.default_rng(4).normal(size=(9, 13))
    surface = CubicSurface.through(heights, 5.0, -3.0, 2.0, 4.0)
    x, y = np.array([6.0, 20.3]), np.array([0.5, 17.7])
    turned = surface.transposed()
    assert turned.height_and_gradient(y, x)[0] == pytest.approx(
        surface.height_and_gradient(x, y)[0]
    )


def test_scalars_give_scalars_and_arrays_keep_their_shape():
    """The result has the shape of the points."""
    surface = CubicSurface.through(np.zeros((4, 4)), 0.0, 0.0, 1.0, 1.0)
    assert surface.height_and_gradient(np.float64(1.0), np.float64(2.0))[0].shape == ()
    assert surface.height_and_gradient(np.ones((2, 3)), np.ones((2, 3)))[1].shape == (2, 3)
