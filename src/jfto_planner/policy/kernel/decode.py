"""The decoder and its rollouts, compiled: one rollout after the other, all in cache.

It computes what decoder.py does, in single precision; a test holds the two to the same choices.
Products are written as sums of scaled rows, which vectorise without reordering a sum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jfto_planner.policy.kernel.arrays import Array, Fleet, Scene, View
from jfto_planner.policy.kernel.observe import observe_one, step_one
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct


@dataclass(frozen=True, eq=False)
class Net(KernelStruct):
    """Weights of the decoder, every matrix as (inputs, outputs)."""

    state: Array
    state_bias: Array
    context: Array
    context_bias: Array
    glimpse_output: Array
    query: Array
    pair_input: Array
    pair_bias: Array
    pair_query: Array
    pair_output: Array
    stop_bias: float
    heads: int
    clip: float


@dataclass(frozen=True, eq=False)
class Known(KernelStruct):
    """Projections of the nodes of B problems, as in Keys; attention's keys are (B, D, W)."""

    graph: Array  # (B, D)
    node_part: Array  # (B, S + W, 4, D)
    glimpse_key: Array  # (B, D, W)
    glimpse_value: Array  # (B, W, D)
    pointer_key: Array  # (B, D, W)
    pair_key: Array  # (B, W, PAIR_WIDTH)
    stop_key: Array  # (B, S + W, D)


@dataclass(frozen=True, eq=False)
class Room(KernelStruct):
    """Room for one rollout to work in."""

    inner: Array  # (D,)
    context: Array  # (D,)
    mixed: Array  # (D,)
    glimpse: Array  # (D,)
    query: Array  # (D,)
    pair: Array  # (PAIR_WIDTH,)
    hidden: Array  # (PAIR_WIDTH,)
    score: Array  # (W + 1,)
    log_p: Array  # (W + 1,)
    places: Array  # (A, 3)
    degree: Array  # (A,)


@inner
def _copy(source: Array, out: Array) -> None:
    for i in range(len(out)):
        out[i] = source[i]


@inner
def _multiply(weight: Array, vector: Array, out: Array) -> None:
    """Add the product of a vector and (inputs, outputs) to `out`."""
    for i in range(weight.shape[0]):
        value = vector[i]
        for j in range(weight.shape[1]):
            out[j] += value * weight[i, j]


@inner
def _add_mean(scene: Scene, known: Known, view: View, b: int, p: int, t: int, out: Array) -> None:
    """Add the mean parts of waypoints taken and left, and of where the UAVs are."""
    waypoints, uavs = scene.waypoints.shape[1], scene.speed.shape[1]
    taken, left = 0, 0
    for j in range(waypoints):
        if not view.visited[b, p, t, j]:
            left += 1
        elif scene.waypoint_valid[b, j]:
            taken += 1
    share_taken = np.float32(1 / max(taken, 1))
    share_left = np.float32(1 / max(left, 1))
    for j in range(waypoints):
        part, share = 1, share_left
        if view.visited[b, p, t, j]:
            if not scene.waypoint_valid[b, j]:
                continue
            part, share = 0, share_taken
        row = known.node_part[b, scene.starts + j, part]
        for i in range(len(out)):
            out[i] += share * row[i]
    flying = 0
    for a in range(uavs):
        flying += scene.uav_valid[b, a]
    share = np.float32(1 / max(flying, 1))
    for a in range(uavs):
        if scene.uav_valid[b, a]:
            row = known.node_part[b, view.node[b, p, t, a], 3]
            for i in range(len(out)):
                out[i] += share * row[i]
    row = known.node_part[b, view.node[b, p, t, view.active[b, p, t]], 2]
    for i in range(len(out)):
        out[i] += row[i]


@inner
def _glimpse(known: Known, heads: int, view: View, b: int, p: int, t: int, room: Room) -> None:
    """Multi-head attention of the context over unvisited waypoints, into `mixed`."""
    waypoints = known.pair_key.shape[1]
    width = len(room.context) // heads
    scale = np.float32(1 / math.sqrt(width))
    any_left = False
    for j in range(waypoints):
        any_left |= not view.visited[b, p, t, j]
    room.mixed[:] = 0
    for head in range(heads):
        room.score[:] = 0
        for i in range(head * width, (head + 1) * width):
            value = room.context[i] * scale
            for j in range(waypoints):
                room.score[j] += value * known.glimpse_key[b, i, j]
        highest = -np.inf
        for j in range(waypoints):
            if not (any_left and view.visited[b, p, t, j]):
                highest = max(highest, room.score[j])
        total = 0.0
        for j in range(waypoints):
            room.log_p[j] = 0
            if not (any_left and view.visited[b, p, t, j]):
                room.log_p[j] = math.exp(room.score[j] - highest)
                total += room.log_p[j]
        for j in range(waypoints):
            if room.log_p[j] > 0:
                share = np.float32(room.log_p[j] / total)
                for i in range(head * width, (head + 1) * width):
                    room.mixed[i] += share * known.glimpse_value[b, j, i]


@inner
def _score_pairs(net: Net, known: Known, view: View, b: int, p: int, t: int, room: Room) -> None:
    """Add the additive attention over pair features to the scores of unvisited waypoints."""
    _copy(net.pair_bias, room.pair)
    _multiply(net.pair_query, room.glimpse, room.pair)
    for j in range(known.pair_key.shape[1]):
        if view.visited[b, p, t, j]:
            continue
        for i in range(len(room.hidden)):
            room.hidden[i] = room.pair[i] + known.pair_key[b, j, i]
        _multiply(net.pair_input, view.pair[b, p, t, j], room.hidden)
        total = np.float32(0)
        for i in range(len(room.hidden)):
            total += max(room.hidden[i], np.float32(0)) * net.pair_output[i]
        room.score[j] += total


@inner
def decide(
    scene: Scene, net: Net, known: Known, view: View, b: int, p: int, t: int, room: Room
) -> None:
    """Fill `log_p` with the log probabilities of the choices of an observation."""
    waypoints, width = known.pair_key.shape[1], len(room.context)
    _copy(net.state_bias, room.inner)
    _multiply(net.state, view.state[b, p, t], room.inner)
    _add_mean(scene, known, view, b, p, t, room.inner)
    for i in range(width):
        room.inner[i] = max(room.inner[i], np.float32(0))
        room.context[i] = net.context_bias[i] + known.graph[b, i]
    _multiply(net.context, room.inner, room.context)
    _glimpse(known, net.heads, view, b, p, t, room)
    _copy(room.context, room.glimpse)
    _multiply(net.glimpse_output, room.mixed, room.glimpse)
    room.query[:] = 0
    _multiply(net.query, room.glimpse, room.query)
    scale = np.float32(1 / math.sqrt(width))
    room.score[:] = 0
    for i in range(width):
        value = room.query[i] * scale
        for j in range(waypoints):
            room.score[j] += value * known.pointer_key[b, i, j]
    _score_pairs(net, known, view, b, p, t, room)
    stop = np.float32(0)
    own = view.node[b, p, t, view.active[b, p, t]]
    for i in range(width):
        stop += room.query[i] * known.stop_key[b, own, i]
    room.score[waypoints] = stop * scale + net.stop_bias
    highest = -np.inf
    for j in range(waypoints + 1):
        room.log_p[j] = -np.inf
        if view.allowed[b, p, t, j]:
            room.log_p[j] = net.clip * math.tanh(room.score[j])
            highest = max(highest, room.log_p[j])
    total = 0.0
    for j in range(waypoints + 1):
        if view.allowed[b, p, t, j]:
            total += math.exp(room.log_p[j] - highest)
    shift = highest + math.log(total)
    for j in range(waypoints + 1):
        room.log_p[j] -= shift


@inner
def _choose(log_p: Array, chance: float) -> int:
    """The likeliest choice if `chance` is negative, else the one at that point of the sum."""
    best, reached = 0, 0.0
    for j in range(len(log_p)):
        if chance < 0:
            if log_p[j] > log_p[best]:
                best = j
        elif log_p[j] > -np.inf:
            best = j
            reached += math.exp(log_p[j])
            if reached > chance:
                break
    return best


@kernel
def roll_out(
    scene: Scene,
    fleet: Fleet,
    view: View,
    net: Net,
    known: Known,
    chances: Array,
    choices: Array,
    uavs: Array,
    likelihood: Array,
    room: Room,
) -> None:
    """Whole rollouts of every problem; `chances` (B, P, T) are uniform numbers, or negative for the
    likeliest choices. Fills `choices` and `uavs` (B, P, T) and `likelihood` (B, P). A view of more
    than one step records them all.
    """
    recorded = view.active.shape[2] > 1
    for b in range(choices.shape[0]):
        for p in range(choices.shape[1]):
            for step in range(choices.shape[2]):
                t = step if recorded else 0
                if not recorded:
                    view.pair[b, p, t] = 0
                    view.state[b, p, t] = 0
                observe_one(scene, fleet, b, p, t, view, room.places, room.degree)
                decide(scene, net, known, view, b, p, t, room)
                choice = _choose(room.log_p, chances[b, p, step])
                choices[b, p, step] = choice
                uavs[b, p, step] = view.active[b, p, t]
                likelihood[b, p] += room.log_p[choice]
                step_one(scene, fleet, b, p, t, view, choice)
