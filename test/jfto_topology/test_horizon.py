"""When a slot's topology is due and what it holds."""

from __future__ import annotations

import pytest

from jfto_msgs_py.errors import InputError
from jfto_topology.horizon import HorizonSettings, TopologyHorizon
from jfto_topology.links import Links
from jfto_world.radio import LogDistanceChannel
from support.fleets import at, column, pose

SETTINGS = HorizonSettings(10, 2.0, horizon_slots=4, stale_after_s=3.0, pose_wait_s=0.5)


def _horizon(count: int, *, k_min: int = 2, reach_m: float = 1000.0) -> TopologyHorizon:
    # With gain 1 at 1 m and a sensitivity of 1 / reach², 1 W reaches exactly reach_m.
    links = Links(
        LogDistanceChannel(1.0),
        {f"uav{index + 1}": 1.0 for index in range(count)},
        reach_m**-2,
        k_min,
        2,
    )
    return TopologyHorizon(column(count), links, SETTINGS)


def _measure(horizon: TopologyHorizon, seconds: float, uavs: range) -> None:
    for index in uavs:
        horizon.prediction.set_pose(f"uav{index + 1}", pose(seconds, 5 * seconds, 100.0 * index))


def test_a_slot_is_due_when_all_poses_have_come() -> None:
    """Due at once when every pose is newer than the slot's beginning, and only once."""
    horizon = _horizon(3)
    _measure(horizon, 2.1, range(2))
    assert not horizon.due(at(2.2))
    _measure(horizon, 2.1, range(3))
    assert horizon.due(at(2.2))
    horizon.solve(at(2.2))
    assert not horizon.due(at(2.3))


def test_before_lift_off_the_first_slot_is_solved_once_all_are_heard() -> None:
    """On the pads there is time: the topology waits for every UAV, and precedes the start."""
    horizon = _horizon(3)
    _measure(horizon, -5.0, range(2))
    assert not horizon.due(at(-4.9))
    _measure(horizon, -4.8, range(3))
    assert horizon.due(at(-4.7))
    found = horizon.solve(at(-4.7))
    assert found is not None
    assert (found.adjacency.horizon.first, found.late, found.excluded) == (0, (), ())
    assert not horizon.due(at(-4.0))


def test_a_late_pose_never_blocks_a_slot() -> None:
    """At the deadline the slot is solved with the last good prediction, and the UAV is named."""
    horizon = _horizon(3)
    _measure(horizon, 1.5, range(3))
    _measure(horizon, 2.1, range(2))
    assert horizon.due(at(2.5))
    found = horizon.solve(at(2.5))
    assert found is not None
    assert (found.late, found.excluded) == (("uav3",), ())
    assert found.adjacency.uav_ids == ("uav1", "uav2", "uav3")


def test_a_stale_uav_is_excluded_and_k_min_follows() -> None:
    """A UAV unheard of for too long takes no part; two left over can have one neighbour each."""
    horizon = _horizon(3)
    _measure(horizon, 1.0, range(3))
    _measure(horizon, 6.1, range(2))
    found = horizon.solve(at(6.5))
    assert found is not None
    assert found.excluded == ("uav3",)
    assert found.adjacency.uav_ids == ("uav1", "uav2")
    assert found.k_min == 1
    assert found.adjacency.links.sum() == 2 * found.adjacency.horizon.count


def test_one_uav_alone_has_no_topology() -> None:
    """With fewer than two fresh UAVs there is nothing to publish."""
    horizon = _horizon(3)
    _measure(horizon, 2.1, range(1))
    assert horizon.solve(at(2.6)) is None


def test_the_horizon_ends_with_the_mission() -> None:
    """Four slots ahead, fewer at the end, the last one being N."""
    horizon = _horizon(3)
    _measure(horizon, 2.1, range(3))
    found = horizon.solve(at(2.2))
    assert found is not None
    assert (found.adjacency.horizon.first, found.adjacency.horizon.count) == (1, 4)
    assert found.adjacency.horizon.t0_ns == at(2.0)
    _measure(horizon, 18.1, range(3))
    last = horizon.solve(at(18.2))
    assert last is not None
    assert (last.adjacency.horizon.first, last.adjacency.horizon.count) == (9, 2)


@pytest.mark.parametrize(
    "values", [{"slot_count": 0}, {"slot_duration_s": 0.0}, {"pose_wait_s": 2.0}]
)
def test_settings_that_make_no_sense_are_refused(values) -> None:
    """Counts, durations and a wait as long as the slot."""
    good = {"slot_count": 10, "slot_duration_s": 2.0, "pose_wait_s": 0.5}
    with pytest.raises(InputError):
        HorizonSettings(**(good | values))


def test_a_fleet_of_one_has_a_topology_without_links() -> None:
    """It is solved as it is heard: power and slots go on, there is only nobody to hear."""
    horizon = _horizon(1, k_min=0)
    _measure(horizon, 2.1, range(1))
    assert horizon.due(at(2.2))
    found = horizon.solve(at(2.2))
    assert found is not None
    assert not found.blind
    assert not found.adjacency.links.any()
    assert found.topology.connected.all()
    assert (found.intervals.bounds_w[..., 0] == 0).all()
