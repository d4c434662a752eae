"""Rules of building routes step by step."""

from __future__ import annotations

import pytest
import torch

from jfto_planner.policy.network.environment import Episode
from support.policy_cases import instances, line_of_three

STOP = 3


def _choose(episode: Episode, choice: int) -> None:
    episode.step(torch.full((1, 1), choice))


def test_the_uav_that_is_free_first_chooses() -> None:
    """After UAV 0 leaves for 0.2 and UAV 1 for 0.1, UAV 1 arrives first and is next."""
    episode = Episode(line_of_three(reach=10), 1)
    assert int(episode.observe().active) == 0
    _choose(episode, 1)
    assert int(episode.observe().active) == 1
    _choose(episode, 0)
    assert int(episode.observe().active) == 1


def test_visited_waypoints_are_masked() -> None:
    """A waypoint is offered once; stopping is offered while another UAV can go on."""
    episode = Episode(line_of_three(reach=10), 1)
    assert episode.observe().allowed[0, 0].tolist() == [True, True, True, True]
    _choose(episode, 1)
    assert episode.observe().allowed[0, 0].tolist() == [True, False, True, True]


def test_the_last_uav_may_not_stop_while_waypoints_are_left() -> None:
    """Once UAV 0 has stopped, UAV 1 must go on until nothing is left, then it must stop."""
    episode = Episode(line_of_three(reach=10), 1)
    episode.observe()
    _choose(episode, STOP)
    for waypoint in (0, 1, 2):
        assert not bool(episode.observe().allowed[0, 0, STOP])
        _choose(episode, waypoint)
    assert episode.observe().allowed[0, 0].tolist() == [False, False, False, True]


def test_waypoints_beyond_t_max_are_masked() -> None:
    """With T_max = 0.5 the waypoint at 0.9 is out of time."""
    allowed = Episode(line_of_three(reach=10, t_max=0.5), 1).observe().allowed
    assert allowed[0, 0].tolist() == [True, True, False, True]


def test_a_choice_that_would_leave_a_uav_alone_is_masked() -> None:
    """With a range of 0.3 and UAV 0 stopped at 0, flying to 0.9 would lose it: masked while 0.1
    and 0.2 are possible, offered and counted as a miss when nothing else is.
    """
    episode = Episode(line_of_three(reach=0.3), 1)
    episode.observe()
    _choose(episode, STOP)
    seen = episode.observe()
    assert seen.keeps_rule[0, 0].tolist() == [True, True, False, True]
    assert seen.allowed[0, 0].tolist() == [True, True, False, False]
    _choose(episode, 0)
    episode.observe()
    _choose(episode, 1)
    assert float(episode.misses) == 0
    assert episode.observe().allowed[0, 0].tolist() == [False, False, True, False]
    _choose(episode, 2)
    assert float(episode.misses) == 1


def test_length_and_lateness_by_hand() -> None:
    """UAV 0 flies 0.2, UAV 1 flies 0.1 then 0.8 more: 1.1 in all, arriving 0.4 after T_max."""
    episode = Episode(line_of_three(reach=10, t_max=0.5), 1)
    for choice in (1, 0):
        episode.observe()
        _choose(episode, choice)
    assert int(episode.observe().active) == 1
    _choose(episode, 2)
    assert float(episode.length) == pytest.approx(1.1)
    assert float(episode.late) == pytest.approx(0.4)


def test_every_rollout_visits_everything_within_a_plus_w_steps() -> None:
    """Random allowed choices end after A + W steps with all waypoints visited, all UAVs done."""
    batch = instances(6, 9, 4, k_min=2)
    episode = Episode(batch, 5)
    generator = torch.Generator().manual_seed(1)
    for _ in range(episode.steps):
        allowed = episode.observe().allowed
        assert allowed.any(-1).all()
        flat = torch.multinomial(allowed.float().flatten(0, 1), 1, generator=generator)
        episode.step(flat.view(6, 5))
    assert episode.visited.all()
    assert episode.done.all()
