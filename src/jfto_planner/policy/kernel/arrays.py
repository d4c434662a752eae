"""Arrays that the compiled episode works on; the meaning of each is that of its tensor twin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jfto_planner.policy.features import PAIR_FEATURES, STATE_FEATURES
from jfto_world.kernel_struct import KernelStruct

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Scene(KernelStruct):
    """B problems: an InstanceBatch's columns, and every waypoint's others, nearest first."""

    waypoints: Array  # (B, W, 3)
    points: Array  # (B, A, 3) where each UAV starts
    start_of: Array  # (B, A)
    speed: Array  # (B, A), as are the next four
    climb: Array
    descent: Array
    t_max: Array
    reach: Array
    k_min: Array  # (B,)
    waypoint_valid: Array  # (B, W)
    uav_valid: Array  # (B, A)
    distance: Array  # (B, W, W)
    nearest: Array  # (B, W, W)
    starts: int  # S, the number of start nodes before the waypoints


@dataclass(frozen=True, eq=False)
class Fleet(KernelStruct):
    """State of B × P rollouts, as in Episode."""

    origin: Array  # (B, P, A, 3)
    target: Array
    depart: Array  # (B, P, A)
    arrive: Array
    done: Array
    visited: Array  # (B, P, W)
    node: Array  # (B, P, A)
    length: Array  # (B, P)
    misses: Array
    late: Array


@dataclass(frozen=True, eq=False)
class View(KernelStruct):
    """What Observation holds, of T steps, and the durations of the legs on offer."""

    active: Array  # (B, P, T)
    now: Array
    allowed: Array  # (B, P, T, W + 1)
    keeps_rule: Array
    visited: Array  # (B, P, T, W)
    duration: Array
    node: Array  # (B, P, T, A)
    state: Array  # (B, P, T, STATE_FEATURES)
    pair: Array  # (B, P, T, W, PAIR_FEATURES)


def empty_fleet(scene: Scene, rollouts: int) -> Fleet:
    """All UAVs at their starts."""
    count, uavs = scene.speed.shape
    start = np.repeat(scene.points[:, None], rollouts, axis=1)
    return Fleet(
        origin=start,
        target=start.copy(),
        depart=np.zeros((count, rollouts, uavs), np.float32),
        arrive=np.zeros((count, rollouts, uavs), np.float32),
        done=np.repeat(~scene.uav_valid[:, None], rollouts, axis=1),
        visited=np.repeat(~scene.waypoint_valid[:, None], rollouts, axis=1),
        node=np.repeat(scene.start_of[:, None], rollouts, axis=1),
        length=np.zeros((count, rollouts), np.float32),
        misses=np.zeros((count, rollouts), np.float32),
        late=np.zeros((count, rollouts), np.float32),
    )


def empty_view(scene: Scene, rollouts: int, steps: int) -> View:
    """Room for the observations of so many steps."""
    count, uavs = scene.speed.shape
    waypoints = scene.waypoints.shape[1]
    shape = (count, rollouts, steps)
    return View(
        active=np.zeros(shape, np.int64),
        now=np.zeros(shape, np.float32),
        allowed=np.zeros((*shape, waypoints + 1), np.bool_),
        keeps_rule=np.zeros((*shape, waypoints + 1), np.bool_),
        visited=np.zeros((*shape, waypoints), np.bool_),
        duration=np.zeros((*shape, waypoints), np.float32),
        node=np.zeros((*shape, uavs), np.int64),
        state=np.zeros((*shape, STATE_FEATURES), np.float32),
        pair=np.zeros((*shape, waypoints, PAIR_FEATURES), np.float32),
    )
