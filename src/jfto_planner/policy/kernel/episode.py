"""Compiled rollouts: their state, what is seen of it, and room to work in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import AnyArray
from jfto_planner.policy.observation import Observation, room_for
from jfto_planner.policy.problems import Problems
from jfto_world.kernel_struct import KernelStruct


@dataclass(frozen=True, eq=False)
class Episode(KernelStruct):
    """B × P rollouts; the twin in tensors is network/environment.py.

    `origin`, `target` (B, P, A, 3), `depart`, `arrive`, `done` and `node` (B, P, A) are of each
    UAV's last leg, `visited` is (B, P, W); `length`, `misses` and `late` (B, P) add up. `distance`
    (B, W, W) is that of two waypoints, `nearest` lists the others of each, nearest first. `places`
    (A, 3) and `degree` (A,) are room to work in.
    """

    problems: Problems[AnyArray]
    seen: Observation[AnyArray]
    origin: AnyArray
    target: AnyArray
    depart: AnyArray
    arrive: AnyArray
    done: AnyArray
    visited: AnyArray
    node: AnyArray
    length: AnyArray
    misses: AnyArray
    late: AnyArray
    distance: AnyArray
    nearest: AnyArray
    places: AnyArray
    degree: AnyArray


def new_episode(problems: Problems[AnyArray], rollouts: int, *, recorded: bool) -> Episode:
    """All UAVs at their starts, with room to see one step at a time, or all where `recorded`."""
    problems = problems.numpy()
    count, uavs = problems.speed.shape
    waypoints = problems.waypoints
    points = np.take_along_axis(problems.starts, problems.start_of[..., None], axis=1)
    start = np.repeat(points[:, None], rollouts, axis=1)
    distance = np.sqrt(((waypoints[:, :, None] - waypoints[:, None]) ** 2).sum(-1))
    return Episode(
        problems=problems,
        seen=room_for(problems, rollouts, uavs + waypoints.shape[1] if recorded else 1),
        origin=start,
        target=start.copy(),
        depart=np.zeros((count, rollouts, uavs), np.float32),
        arrive=np.zeros((count, rollouts, uavs), np.float32),
        done=np.repeat(~problems.uav_valid[:, None], rollouts, axis=1),
        visited=np.repeat(~problems.waypoint_valid[:, None], rollouts, axis=1),
        node=np.repeat(problems.start_of[:, None], rollouts, axis=1),
        length=np.zeros((count, rollouts), np.float32),
        misses=np.zeros((count, rollouts), np.float32),
        late=np.zeros((count, rollouts), np.float32),
        distance=distance,
        # Not a stable sort, which is slower: the kernels read no more than distances from it.
        nearest=np.argsort(distance, axis=-1).astype(np.int32),
        places=np.zeros((uavs, 3)),
        degree=np.zeros(uavs, np.int64),
    )
