"""Rules of distance between vehicles in continuous time."""

import numpy as np
import pytest

from jfto_msgs_py.errors import InfeasibleError
from jfto_planner.smoothing import (
    CurveLimits,
    RouteRequest,
    SeparationSettings,
    separate,
    smooth_route,
)
from support.curves import closest_approach_m

LIMITS = CurveLimits(8.0, 3.0, 2.0)


def flight(*points):
    return smooth_route(RouteRequest(np.array(points, dtype=float), LIMITS))


CROSSING = (
    flight((-100, 0, 50), (100, 0, 50)),
    flight((0, -100, 50), (0, 100, 50)),
    flight((-100, 30, 50), (100, -30, 50)),
)


def test_closest_approach_is_found_between_samples():
    """The closest approach agrees with dense sampling to a millimetre, though sampled coarsely."""
    found_m = closest_approach_m(CROSSING[:2], check_s=0.5)
    times = np.linspace(0, 40, 400_001)
    gap = np.linalg.norm(CROSSING[0].positions(times) - CROSSING[1].positions(times), axis=1)
    assert found_m == pytest.approx(gap.min(), abs=2e-3)
    assert closest_approach_m(CROSSING[:1]) == np.inf


def test_conflicts_are_resolved_by_small_delays():
    """All pairs end at least d_min apart; the first vehicle is unchanged, paths are kept."""
    apart = separate(CROSSING, 10.0)
    assert closest_approach_m(apart) >= 10.0 - 1e-6
    assert apart[0] is CROSSING[0]
    for before, after in zip(CROSSING, apart, strict=True):
        assert after.control_m.tobytes() == before.control_m.tobytes()
        assert after.end_s - before.end_s <= 8.0


def test_fleets_without_conflict_are_not_changed():
    """Vehicles that are far apart are returned as they are."""
    far = (CROSSING[0], flight((-100, 80, 50), (100, 80, 50)))
    assert separate(far, 10.0) == far


def test_the_neighbour_rule_has_the_last_word():
    """A change that the check refuses is not made; if it refuses all, the pair is named."""
    seen = []

    def refuse_late(positions_m):
        seen.append(positions_m.shape)
        return len(seen) > 3

    apart = separate(CROSSING[:2], 10.0, neighbours_kept=refuse_late)
    assert len(seen) == 4
    assert seen[0][1:] == (2, 3)
    assert closest_approach_m(apart) >= 10.0 - 1e-6
    with pytest.raises(InfeasibleError, match="UAVs 0 and 1"):
        separate(CROSSING[:2], 10.0, neighbours_kept=lambda positions_m: False)


def test_a_blocked_pad_cannot_be_resolved():
    """Two vehicles on one pad stay too close whatever the delay."""
    settings = SeparationSettings(delay_max_s=2.0, slow_max=1.0)
    with pytest.raises(InfeasibleError, match="d_min"):
        separate((CROSSING[0], CROSSING[0]), 10.0, settings)
