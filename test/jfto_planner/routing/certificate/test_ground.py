"""Rules of the check of height along the whole flight."""

import numpy as np
import pytest

from jfto_planner.routing.certificate.ground import GroundRule, heights_m


def flat(x_m, y_m):
    """Ground at height 0."""
    return 0.0 * x_m * y_m


@pytest.mark.parametrize(
    ("places", "low"),
    [
        ([[0, 0, 0], [0, 0, 10], [30, 0, 14], [60, 0, 40]], [0, 0, 0, 0]),
        ([[0, 0, 0], [0, 0, 10], [30, 0, 4], [60, 0, 40]], [0, 0, 1, 0]),
        ([[0, 0, 0], [0, 0, 20], [30, 0, 14], [60, 0, 40]], [0, 0, 1, 0]),
        ([[0, 0, 0], [0, 0, 0]], [0, 0]),
    ],
)
def test_height_is_wanted_once_it_was_reached(places, low):
    """15 m from the first time on, 5 m away from the pad before; who stays on its pad is well."""
    above, needed = heights_m(np.array(places, dtype=float), np.zeros(3), GroundRule(flat, 15, 5))
    assert (above < needed).astype(int).tolist() == low
