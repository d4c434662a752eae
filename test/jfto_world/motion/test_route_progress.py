"""Following a UAV along its route: late, held up, off it, over it twice, badly measured."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_world.motion.progress import sample
from jfto_world.motion.route_progress import RouteProgress
from support.fleets import START_NS

# Out along x, a hold of 10 s, a loop that crosses the way out at (100, 0) after 90 s, and away.
CORNERS_S = np.array([0.0, 30.0, 40.0, 60.0, 75.0, 110.0, 130.0])
CORNERS_M = np.array(
    [[0, 0], [240, 0], [240, 0], [240, 160], [100, 160], [100, -120], [0, -280]], dtype=np.float64
)
CORNERS_M = np.concatenate([CORNERS_M, np.zeros((7, 1))], axis=1)
ROUTE = TimedTrajectory(
    START_NS,
    np.rint(CORNERS_S * 1e9).astype(np.int64),
    CORNERS_M,
    np.zeros_like(CORNERS_M),
    np.zeros_like(CORNERS_M),
)


def _place(reached_s: float) -> np.ndarray:
    return sample(CORNERS_S, CORNERS_M, np.array([reached_s]))[0]


def _fly(progress, begin_s, end_s, reached, *, noise_m=0.0, seed=0, every_s=0.2) -> None:
    """Positions from `begin_s` to `end_s`; `reached` gives the place on the route, in seconds."""
    rng = np.random.default_rng(seed)
    for at_s in np.arange(begin_s, end_s, every_s):
        where = _place(reached(at_s)) + rng.normal(0, noise_m, 3)
        progress.update(START_NS + round(at_s * 1e9), where)


def test_a_lag_grows_without_limit_while_the_uav_hovers() -> None:
    """Held up for 60 s in the middle of a leg, six times the window, it is 60 s late, not lost."""
    progress = RouteProgress(ROUTE)
    _fly(progress, 0.0, 120.0, lambda at_s: min(at_s, 20.0) if at_s < 80 else at_s - 60)
    assert progress.lag_s == pytest.approx(60.0, abs=0.3)
    assert progress.following


@pytest.mark.parametrize("lag_s", [0.0, 25.0, 75.0])
def test_a_lag_of_any_size_is_found_anew_in_mid_flight(lag_s) -> None:
    """The first poses after a restart tell where on its route the UAV is, within a slot of 3 s."""
    progress = RouteProgress(ROUTE)
    _fly(progress, 100.0, 103.0, lambda at_s: at_s - lag_s)
    assert progress.lag_s == pytest.approx(lag_s, abs=0.5)


@pytest.mark.parametrize("lag_s", [0.0, 77.5])
def test_at_a_crossing_what_comes_next_decides(lag_s) -> None:
    """Found first where the route crosses itself, one second later the direction tells which."""
    progress = RouteProgress(ROUTE)
    _fly(progress, 89.0, 95.0, lambda at_s: at_s - lag_s, noise_m=2.0)
    assert progress.lag_s == pytest.approx(lag_s, abs=1.0)


def test_a_planned_hold_is_no_lag_and_a_longer_one_is() -> None:
    """On time through the hold, then 15 s late when the UAV stays there for 25 s."""
    progress = RouteProgress(ROUTE)
    _fly(progress, 0.0, 39.0, lambda at_s: at_s)
    assert progress.lag_s == pytest.approx(0.0, abs=0.01)
    _fly(progress, 39.0, 60.0, lambda at_s: max(at_s - 15, min(at_s, 40.0)))
    assert progress.lag_s == pytest.approx(15.0, abs=1.5)


def test_five_metres_of_noise_cost_about_a_second() -> None:
    """Over the whole route, 20 s late from its start, with noise of 5 m in each axis."""
    progress, worst_s = RouteProgress(ROUTE), 0.0
    for begin_s in np.arange(20.0, 140.0, 5.0):
        _fly(progress, begin_s, begin_s + 5, lambda at_s: at_s - 20, noise_m=5.0, seed=int(begin_s))
        if not 45 <= begin_s <= 65:  # holding, no clock can be seen
            worst_s = max(worst_s, abs(progress.lag_s - 20))
    assert worst_s < 1.5


def test_a_glitch_is_not_believed_and_a_detour_is() -> None:
    """Two seconds 500 m away change no lag; five do: the UAV has left its route, and comes back."""
    progress = RouteProgress(ROUTE)
    _fly(progress, 0.0, 10.0, lambda at_s: at_s)
    for at_s in np.arange(10.0, 12.0, 0.2):
        progress.update(START_NS + round(at_s * 1e9), np.array([500.0, 500, 0]))
    assert progress.lag_s == pytest.approx(0.0, abs=0.01)
    assert progress.following
    for at_s in np.arange(12.0, 15.0, 0.2):
        progress.update(START_NS + round(at_s * 1e9), np.array([500.0, 500, 0]))
    assert progress.off_route
    assert not progress.following
    _fly(progress, 30.0, 33.0, lambda at_s: at_s - 18)
    assert progress.following
    assert progress.lag_s == pytest.approx(18.0, abs=0.5)


def test_the_way_home_is_no_part_of_the_route() -> None:
    """Three seconds at its last waypoint a UAV is done, and stays so when it flies home over it."""
    progress = RouteProgress(ROUTE)
    _fly(progress, 100.0, 129.0, lambda at_s: at_s)
    assert not progress.done
    _fly(progress, 129.0, 134.0, lambda at_s: at_s)
    assert progress.done
    _fly(progress, 135.0, 165.0, lambda at_s: 265.0 - at_s)
    assert progress.done
    assert not progress.following


def test_before_its_start_a_uav_has_no_lag() -> None:
    """Wherever it stands, it is predicted to begin on time."""
    progress = RouteProgress(ROUTE)
    progress.update(START_NS - 10**9, np.array([3.0, 0.0, 0.0]))
    assert progress.lag_s == 0.0
    assert not progress.following


def test_sparse_positions_are_enough() -> None:
    """One each 15 s, longer than the window, of a UAV that loses 3 s in each of them."""
    progress = RouteProgress(ROUTE)
    _fly(progress, 0.0, 91.0, lambda at_s: 0.8 * at_s, every_s=15.0)
    assert progress.lag_s == pytest.approx(18.0, abs=3.0)


def test_standing_still_is_seen_in_three_seconds_and_a_planned_hold_is_none() -> None:
    """Not on the way, not in the hold at 240 m; three seconds after it should have gone on."""
    progress = RouteProgress(ROUTE)
    for end_s in np.arange(5.0, 40.5, 5.0):
        _fly(progress, end_s - 5, end_s, lambda at_s: at_s)
        assert not progress.stands
    _fly(progress, 40.0, 44.0, lambda at_s: 40.0)
    assert progress.stands
    _fly(progress, 44.0, 48.0, lambda at_s: at_s - 4.0)
    assert not progress.stands
