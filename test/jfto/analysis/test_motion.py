"""How each UAV of a plan moves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jfto.analysis.motion import flight_spread, motions, spread_text
from jfto.pipeline.run import Run
from jfto_msgs_py.records.plan import Plan


def test_flights_are_where_the_plan_says(tiny_run: tuple[Path, Run], tiny_guided: Plan) -> None:
    """At each arrival a UAV is at its waypoint, or within the radius at which corners are cut."""
    for plan, radius_m in ((tiny_run[1].plan, 2.5), (tiny_guided, 0.5)):
        where = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
        for flight, route in zip(motions(plan), plan.routes, strict=True):
            for number, time in zip(route.waypoint_ids, route.arrival_s, strict=True):
                k = int(np.argmin(np.abs(flight.times_s - time)))
                assert np.linalg.norm(flight.position_m[k] - where[number]) < radius_m


def test_guided_flights_keep_their_limits(tiny_guided: Plan) -> None:
    """Sampled jerk never exceeds what the plan was made with."""
    for flight in motions(tiny_guided):
        assert flight.jerk_mps3 is not None
        assert flight.jerk_mps3.max() <= tiny_guided.time_parameters["jerk_mps3"]


def test_wind_spreads_arrivals_and_calm_does_not(tiny_run: tuple[Path, Run]) -> None:
    """Without wind the closed loop arrives as planned; with wind some arrivals differ."""
    plan = tiny_run[1].plan
    for one in flight_spread(plan, 0.0):
        assert one.wind_s == pytest.approx((0.0, 0.0), abs=1e-3)
        assert one.planner_s[0] < 0
    windy = flight_spread(plan, 4.0)
    assert max(one.wind_s[1] for one in windy) > 0.02
    assert "4 m/s" in spread_text(windy, 4.0)


def test_a_streamed_plan_has_no_spread(tiny_guided: Plan) -> None:
    """Guided flight goes by the clock."""
    assert flight_spread(tiny_guided, 3.0) == ()
    assert spread_text((), 3.0) == ""
