"""Rules of the choice between candidate curves."""

import numpy as np
import pytest

from jfto_planner.smoothing import CurveLimits, RouteRequest, smooth, smooth_route


@pytest.mark.slow
def test_the_faster_candidate_is_kept(monkeypatch):
    """Trying a narrower corridor too never makes a route slower than the full one alone."""
    limits = CurveLimits(10.0, 5.0, 3.0)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        walk = np.cumsum(rng.uniform(-1, 1, (10, 2)), axis=0) * 70.0
        request = RouteRequest(np.column_stack([walk, rng.uniform(40, 50, 10)]), limits)
        both = smooth_route(request).end_s
        monkeypatch.setattr(smooth, "_NARROW", 1.0)
        assert both <= smooth_route(request).end_s + 1e-9
        monkeypatch.undo()
