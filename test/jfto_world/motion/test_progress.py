"""Finding a measured position on a trajectory."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_world.motion.progress import passes, progress_time, sample

# Out along x at 5 m/s, a hold of 4 s, and back the same way.
TIMES = np.array([0.0, 10.0, 14.0, 24.0])
POINTS = np.array([[0.0, 0, 0], [50, 0, 0], [50, 0, 0], [0, 0, 0]])


@pytest.mark.parametrize(
    ("measured_m", "expected_s", "answer_s"),
    [
        ((20.0, 3.0, 0.0), 5.0, 4.0),  # beside the way out, 1 s late
        ((20.0, 0.0, 0.0), 19.0, 20.0),  # the same place on the way back
        ((50.0, 0.0, 0.0), 12.5, 12.5),  # holding: nothing contradicts the expectation
        ((50.0, 0.0, 0.0), 9.0, 10.0),  # early at the hold
        ((-9.0, 0.0, 0.0), 1.0, 0.0),  # behind the start
        ((0.0, 0.0, 0.0), 99.0, 24.0),  # long after the end
    ],
)
def test_progress_by_hand(measured_m, expected_s, answer_s) -> None:
    """Nearest place within the window; holds and way-backs are told apart by the expectation."""
    found, off_m = progress_time(
        TIMES, POINTS, np.array(measured_m), expected_s, expected_s - 4, expected_s + 4, 1e-3
    )
    assert found == pytest.approx(answer_s, abs=1e-6)
    place = sample(TIMES, POINTS, np.array([found]))[0]
    assert off_m == pytest.approx(np.linalg.norm(place - measured_m))


def test_the_pull_weighs_seconds_against_metres() -> None:
    """At 5 m/s with a pull of 5 m/s a place 2 s late is met half way, 1 s late and 5 m off."""
    found, off_m = progress_time(TIMES, POINTS, np.array([20.0, 0, 0]), 6.0, 0.0, 24.0, 5.0)
    assert found == pytest.approx(5.0)
    assert off_m == pytest.approx(5.0)


def test_passes_by_hand() -> None:
    """Out, and back over the same place; not the pass that lies ahead of the clock."""
    here = np.array([20.0, 3.0, 0.0])
    assert passes(TIMES, POINTS, here, 99.0, 10.0).tolist() == pytest.approx([4.0, 20.0])
    assert passes(TIMES, POINTS, here, 15.0, 10.0).tolist() == pytest.approx([4.0])
    assert passes(TIMES, POINTS, here, 99.0, 2.0).tolist() == []
    assert passes(TIMES[:1], POINTS[:1], here, 99.0, 30.0).tolist() == [0.0]


@settings(deadline=None, max_examples=60)
@given(st.floats(0, 24), st.floats(-2, 2))
def test_a_uav_on_its_trajectory_is_found_there(true_s, error_s) -> None:
    """Whatever the clock error within the window, the place found is the measured place."""
    measured = sample(TIMES, POINTS, np.array([true_s]))[0]
    expected_s = true_s + error_s
    found, off_m = progress_time(
        TIMES, POINTS, measured, expected_s, expected_s - 3, expected_s + 3, 1e-3
    )
    assert off_m < 0.02
    assert np.allclose(sample(TIMES, POINTS, np.array([found]))[0], measured, atol=0.02)
