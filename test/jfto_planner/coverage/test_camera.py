import pytest

from jfto_msgs_py.errors import InputError
from jfto_planner.coverage import Camera


def test_footprint_and_resolution_follow_from_similar_triangles():
    """36 × 24 mm behind 24 mm at 100 m sees 150 × 100 m; 6000 px make 2.5 cm each."""
    camera = Camera(36.0, 24.0, 24.0, 6000, 4000)
    assert camera.footprint_m(100.0) == pytest.approx((150.0, 100.0))
    assert camera.gsd_m(100.0) == pytest.approx(0.025)
    assert camera.distance_for_gsd(0.025) == pytest.approx(100.0)


def test_a_footprint_defines_the_camera():
    """A camera given by L × W at a distance has that footprint there and scales with distance."""
    camera = Camera.from_footprint(215.0, 160.0, 140.0, 5472, 3648)
    assert camera.footprint_m(140.0) == pytest.approx((215.0, 160.0))
    assert camera.footprint_m(70.0) == pytest.approx((107.5, 80.0))
    assert camera.gsd_m(140.0) == pytest.approx(160.0 / 3648)


@pytest.mark.parametrize("position", range(5))
@pytest.mark.parametrize("value", [0, -1, float("nan"), float("inf")])
def test_sizes_must_be_positive(position, value):
    """Every size of a camera is checked and named."""
    sizes = [36.0, 24.0, 24.0, 6000, 4000]
    sizes[position] = value
    with pytest.raises(InputError, match=r"camera\."):
        Camera(*sizes)
    with pytest.raises(InputError, match="camera"):
        Camera.from_footprint(*sizes)
