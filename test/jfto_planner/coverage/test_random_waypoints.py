import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_planner.coverage import random_waypoints
from jfto_world.terrain import load_dem


@pytest.fixture(scope="module")
def dem():
    return load_dem("jacksboro", center=(36.6301, -84.2626), size_m=(1200, 600))


@pytest.mark.parametrize("kind", ["uniform", "gaussian"])
def test_sets_lie_in_the_area_at_their_height_and_repeat_with_their_seed(dem, kind):
    """All points inside, exactly height_m above ground, same seed same points."""
    drawn = random_waypoints(kind, 500, dem, 80.0, np.random.default_rng(3))
    place = np.array([w.position_m for w in drawn])
    assert (np.abs(place[:, :2]) <= [600, 300]).all()
    assert place[:, 2] - dem.height(place[:, 0], place[:, 1]) == pytest.approx(80.0)
    assert [w.id for w in drawn] == list(range(500))
    assert drawn == random_waypoints(kind, 500, dem, 80.0, np.random.default_rng(3))
    assert drawn != random_waypoints(kind, 500, dem, 80.0, np.random.default_rng(4))


def test_gaussian_sets_crowd_in_the_middle(dem):
    """Standard deviations are a sixth of the sides, against 0.29 of the sides for uniform ones."""
    spread = {
        kind: np.std(
            [w.position_m[:2] for w in random_waypoints(kind, 4000, dem, 50.0, rng)], axis=0
        )
        for kind, rng in (
            ("uniform", np.random.default_rng(0)),
            ("gaussian", np.random.default_rng(0)),
        )
    }
    assert spread["gaussian"] == pytest.approx(np.array([200, 100]), rel=0.06)
    assert spread["uniform"] == pytest.approx(np.array([1200, 600]) / np.sqrt(12), rel=0.06)


@pytest.mark.parametrize(
    ("kind", "count", "height"),
    [("poisson", 5, 10.0), ("uniform", 0, 10.0), ("uniform", 5, -1.0), ("uniform", 5, np.nan)],
)
def test_impossible_sets_are_refused(dem, kind, count, height):
    """Unknown kind, no points and no height raise InputError."""
    with pytest.raises(InputError):
        random_waypoints(kind, count, dem, height, np.random.default_rng(0))
