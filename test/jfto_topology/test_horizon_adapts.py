"""What the topology makes of poses that are late, missing, out of order or jump, and of clocks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_topology.horizon import HorizonSettings, HorizonTopology, Links, TopologyHorizon
from jfto_world.radio import LogDistanceChannel
from support.fleets import at, column, pose

SLOTS, SLOT_S, WAIT_S = 10, 2.0, 0.5


def _horizon() -> TopologyHorizon:
    links = Links(LogDistanceChannel(1.0), dict.fromkeys(("uav1", "uav2", "uav3"), 1.0), 1e-6, 2, 2)
    return TopologyHorizon(column(3), links, HorizonSettings(SLOTS, SLOT_S, 4, 3.0, WAIT_S))


def _measure(horizon: TopologyHorizon, seconds: float, uavs=range(3), lag_s: float = 0.0) -> None:
    for index in uavs:
        east_m = 5 * max(seconds - lag_s, 0.0)
        horizon.prediction.set_pose(f"uav{index + 1}", pose(seconds, east_m, 100.0 * index))


def _fly(horizon, begin_s, end_s, measure) -> list[tuple[float, HorizonTopology]]:
    """Ten looks a second; what was solved and when."""
    found = []
    for tick in range(round(begin_s * 10), round(end_s * 10)):
        measure(tick / 10)
        if horizon.due(at(tick / 10)):
            solved = horizon.solve(at(tick / 10))
            if solved is not None:
                found.append((tick / 10, solved))
    return found


def test_with_no_pose_at_all_the_deadline_is_kept_from_the_last_good_prediction() -> None:
    """Silent from 5 s on: each slot still comes, all UAVs in it, late at first and blind then."""
    horizon = _horizon()
    found = _fly(
        horizon, 0.0, 20.0, lambda now_s: _measure(horizon, now_s) if now_s < 5.0 else None
    )
    times = [when for when, _ in found]
    assert times == [0.0, 2.0, 4.0, 6.5, 9.5, 10.5, 12.5, 14.5, 16.5, 18.5]
    assert [solved.blind for _, solved in found] == [False] * 4 + [True] * 6
    assert [solved.adjacency.horizon.first for _, solved in found] == list(range(10))
    last = found[-1][1]
    assert last.adjacency.uav_ids == ("uav1", "uav2", "uav3")
    assert last.late == last.adjacency.uav_ids
    where = horizon.prediction.positions(("uav1",), np.array([at(18.0)]))[0, 0]
    assert where[0] == pytest.approx(90.0, abs=1.0)


def test_a_uav_left_out_is_not_waited_for() -> None:
    """uav3 dies at 3 s: its slot waits for it while it is late, and no more once it is out."""
    horizon = _horizon()
    found = _fly(
        horizon, 0.0, 16.0, lambda now_s: _measure(horizon, now_s, range(3 if now_s < 3 else 2))
    )
    assert [when for when, _ in found] == [0.0, 2.0, 4.5, 6.5, 8.0, 10.0, 12.0, 14.0]
    assert [solved.excluded for _, solved in found][2:] == [(), *[("uav3",)] * 5]


def test_poses_out_of_order_change_nothing() -> None:
    """Each pose followed by one that is a second older, from elsewhere."""
    horizon, calm = _horizon(), _horizon()

    def shuffled(now_s: float) -> None:
        _measure(horizon, now_s)
        _measure(horizon, now_s - 1.0, lag_s=30.0)

    found = _fly(horizon, 0.0, 15.0, shuffled)
    wanted = _fly(calm, 0.0, 15.0, lambda now_s: _measure(calm, now_s))
    assert [when for when, _ in found] == [when for when, _ in wanted]
    assert found[-1][1].lag_s == pytest.approx(0.0, abs=0.01)


def test_a_restarted_node_finds_slot_and_lags_from_the_first_poses() -> None:
    """In mid-flight, 24 s late: slot 3 at 31 s, predicted from where the fleet really is."""
    horizon = _horizon()
    _measure(horizon, 31.0, lag_s=24.0)
    assert horizon.due(at(31.1))
    found = horizon.solve(at(31.1))
    assert found is not None
    assert found.adjacency.horizon.first == 3
    assert found.adjacency.horizon.t0_ns == pytest.approx(at(30.0), abs=10**7)
    assert found.shift_s == pytest.approx(24.0, abs=0.01)
    ahead = horizon.prediction.positions(("uav1",), np.array([at(34.0)]))[0, 0]
    assert ahead[0] == pytest.approx(50.0, abs=0.1)


def test_a_clock_that_is_set_back_is_followed_once_poses_come() -> None:
    """From 13 s back to 4.1 s: slot 2 is solved again with poses of that time."""
    horizon = _horizon()
    _fly(horizon, 0.0, 13.0, lambda now_s: _measure(horizon, now_s))
    horizon.prediction.forget_poses()
    assert not horizon.due(at(4.1))
    _measure(horizon, 4.2)
    assert horizon.due(at(4.2))
    found = horizon.solve(at(4.2))
    assert found is not None
    assert found.adjacency.horizon.first == 2


def test_a_clock_that_jumps_ahead_passes_slots_over() -> None:
    """From 4 s to 13.1 s: the poses of that time are given half a slot, then slot 6 comes."""
    horizon = _horizon()
    _fly(horizon, 0.0, 4.5, lambda now_s: _measure(horizon, now_s))
    assert not horizon.due(at(13.1))
    _measure(horizon, 13.2, range(2))
    assert horizon.due(at(13.2))
    found = horizon.solve(at(13.2))
    assert found is not None
    assert (found.adjacency.horizon.first, found.blind, found.excluded) == (6, False, ("uav3",))


def test_after_the_last_slot_the_fleet_still_relays() -> None:
    """Slot N again and again, each 2 s, on the way home, where the UAVs are measured."""
    horizon = _horizon()

    def home(now_s: float) -> None:
        if now_s < 24.0:
            _measure(horizon, min(now_s, 20.0) if now_s < 20 else now_s, lag_s=max(now_s - 20, 0))
            return
        for index in range(3):
            east_m = 100.0 - 5 * (now_s - 24.0)
            where = pose(now_s, east_m, 100.0 * index + 60)
            horizon.prediction.set_pose(f"uav{index + 1}", where)

    found = _fly(horizon, 0.0, 36.0, home)
    firsts = [solved.adjacency.horizon.first for _, solved in found]
    assert firsts[:11] == list(range(11))
    assert set(firsts[11:]) == {10}
    assert len(firsts) >= 17
    here = horizon.prediction.positions(("uav1",), np.array([at(36.0)]))[0, 0]
    assert here[:2] == pytest.approx([40.5, 60.0])


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_whatever_the_poses_a_slot_is_never_blocked(seed) -> None:
    """Missing, late, jumping by 500 m, 5 m of noise: a topology of all that are fresh each slot."""
    horizon, rng = _horizon(), np.random.default_rng(seed)
    _measure(horizon, 0.0)

    def wild(now_s: float) -> None:
        for index in range(3):
            if rng.random() < 0.7:
                continue
            off_m = rng.normal(0, 5, 2) + (500 if rng.random() < 0.05 else 0)
            then_s = max(now_s - rng.exponential(0.5), 0.0)
            where = pose(then_s, 5 * then_s + off_m[0], 100.0 * index + off_m[1])
            horizon.prediction.set_pose(f"uav{index + 1}", where)

    found = _fly(horizon, 0.0, 20.0, wild)
    times = np.array([when for when, _ in found])
    assert len(times) >= 8
    assert np.diff(times).max() <= 1.25 * SLOT_S + WAIT_S + 0.5 * SLOT_S + 0.1
    firsts = [solved.adjacency.horizon.first for _, solved in found]
    assert np.diff(firsts).min() >= 0
