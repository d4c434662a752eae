"""The decoder and its rollouts, compiled: one rollout after the other, all in cache.

It computes what network/decoder.py does, in single precision; a test holds the two to the same
choices.
Products are written as sums of scaled rows, which vectorise without reordering a sum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Generic, TypeVar

import numpy as np

from jfto_msgs_py.types import AnyArray
from jfto_planner.policy.kernel.episode import Episode
from jfto_planner.policy.kernel.observe import observe_one, step_one
from jfto_world.compiled import inner, kernel
from jfto_world.kernel_struct import KernelStruct

Column = TypeVar("Column")


@dataclass(frozen=True, eq=False)
class Net(KernelStruct):
    """Weights of the decoder, every matrix as (inputs, outputs)."""

    state: AnyArray
    state_bias: AnyArray
    context: AnyArray
    context_bias: AnyArray
    glimpse_output: AnyArray
    query: AnyArray
    pair_input: AnyArray
    pair_bias: AnyArray
    pair_query: AnyArray
    pair_output: AnyArray
    stop_bias: float
    heads: int
    clip: float


@dataclass(frozen=True, eq=False)
class Keys(KernelStruct, Generic[Column]):
    """What stays the same over all steps of B problems: projections of the node embeddings.

    As arrays for compiled rollouts, or tensors. `graph` (B, D) is that of the whole; `node_part`
    (B, S + W, 4, D) is what each node adds to the context as taken waypoint, as waypoint left, as
    the active UAV's place and as another UAV's; `glimpse_key` and `pointer_key` are (B, D, W),
    `glimpse_value` (B, W, D), `pair_key` (B, W, PAIR_WIDTH), `stop_key` (B, S + W, D).
    """

    graph: Column
    node_part: Column
    glimpse_key: Column
    glimpse_value: Column
    pointer_key: Column
    pair_key: Column
    stop_key: Column
    waypoint_valid: Column
    uav_valid: Column

    def numpy(self) -> Keys[AnyArray]:
        """Tensors as arrays, in single precision."""

        def array(tensor: Any) -> AnyArray:
            tensor = tensor.detach()
            tensor = tensor.float() if tensor.is_floating_point() else tensor
            return np.asarray(tensor.contiguous().numpy())

        return Keys(**{item.name: array(getattr(self, item.name)) for item in fields(self)})


@dataclass(frozen=True, eq=False)
class Room(KernelStruct):
    """Room for one rollout to work in."""

    inner: AnyArray  # (D,)
    context: AnyArray  # (D,)
    mixed: AnyArray  # (D,)
    glimpse: AnyArray  # (D,)
    query: AnyArray  # (D,)
    pair: AnyArray  # (PAIR_WIDTH,)
    hidden: AnyArray  # (PAIR_WIDTH,)
    score: AnyArray  # (W + 1,)
    log_p: AnyArray  # (W + 1,)


@dataclass(frozen=True, eq=False)
class Choices(KernelStruct):
    """How B × P rollouts of T steps choose, and what they chose.

    `chances` (B, P, T) are uniform numbers, or negative for the likeliest choices. `choices` and
    `uavs` (B, P, T) say who chose what (W = stop), `likelihood` (B, P) is the logarithm of its
    chance.
    """

    chances: AnyArray
    choices: AnyArray
    uavs: AnyArray
    likelihood: AnyArray


@inner
def _copy(source: AnyArray, out: AnyArray) -> None:
    for i in range(len(out)):
        out[i] = source[i]


@inner
def _multiply(weight: AnyArray, vector: AnyArray, out: AnyArray) -> None:
    """Add the product of a vector and (inputs, outputs) to `out`."""
    for i in range(weight.shape[0]):
        value = vector[i]
        for j in range(weight.shape[1]):
            out[j] += value * weight[i, j]


@inner
def _add_mean(
    episode: Episode, keys: Keys[AnyArray], b: int, p: int, t: int, out: AnyArray
) -> None:
    """Add the mean parts of waypoints taken and left, and of where the UAVs are."""
    problems, seen = episode.problems, episode.seen
    waypoints, uavs = problems.waypoints.shape[1], problems.speed.shape[1]
    taken, left = 0, 0
    for j in range(waypoints):
        if not seen.visited[b, p, t, j]:
            left += 1
        elif keys.waypoint_valid[b, j]:
            taken += 1
    share_taken = np.float32(1 / max(taken, 1))
    share_left = np.float32(1 / max(left, 1))
    for j in range(waypoints):
        part, share = 1, share_left
        if seen.visited[b, p, t, j]:
            if not keys.waypoint_valid[b, j]:
                continue
            part, share = 0, share_taken
        row = keys.node_part[b, problems.starts.shape[1] + j, part]
        for i in range(len(out)):
            out[i] += share * row[i]
    flying = 0
    for a in range(uavs):
        flying += keys.uav_valid[b, a]
    share = np.float32(1 / max(flying, 1))
    for a in range(uavs):
        if keys.uav_valid[b, a]:
            row = keys.node_part[b, seen.node[b, p, t, a], 3]
            for i in range(len(out)):
                out[i] += share * row[i]
    row = keys.node_part[b, seen.node[b, p, t, seen.active[b, p, t]], 2]
    for i in range(len(out)):
        out[i] += row[i]


@inner
def _glimpse(
    episode: Episode, keys: Keys[AnyArray], heads: int, b: int, p: int, t: int, room: Room
) -> None:
    """Multi-head attention of the context over unvisited waypoints, into `mixed`."""
    seen = episode.seen
    waypoints = keys.pair_key.shape[1]
    width = len(room.context) // heads
    scale = np.float32(1 / math.sqrt(width))
    any_left = False
    for j in range(waypoints):
        any_left |= not seen.visited[b, p, t, j]
    room.mixed[:] = 0
    for head in range(heads):
        room.score[:] = 0
        for i in range(head * width, (head + 1) * width):
            value = room.context[i] * scale
            for j in range(waypoints):
                room.score[j] += value * keys.glimpse_key[b, i, j]
        highest = -np.inf
        for j in range(waypoints):
            if not (any_left and seen.visited[b, p, t, j]):
                highest = max(highest, room.score[j])
        total = 0.0
        for j in range(waypoints):
            room.log_p[j] = 0
            if not (any_left and seen.visited[b, p, t, j]):
                room.log_p[j] = math.exp(room.score[j] - highest)
                total += room.log_p[j]
        for j in range(waypoints):
            if room.log_p[j] > 0:
                share = np.float32(room.log_p[j] / total)
                for i in range(head * width, (head + 1) * width):
                    room.mixed[i] += share * keys.glimpse_value[b, j, i]


@inner
def _score_pairs(
    episode: Episode, net: Net, keys: Keys[AnyArray], b: int, p: int, t: int, room: Room
) -> None:
    """Add the additive attention over pair features to the scores of unvisited waypoints."""
    seen = episode.seen
    _copy(net.pair_bias, room.pair)
    _multiply(net.pair_query, room.glimpse, room.pair)
    for j in range(keys.pair_key.shape[1]):
        if seen.visited[b, p, t, j]:
            continue
        for i in range(len(room.hidden)):
            room.hidden[i] = room.pair[i] + keys.pair_key[b, j, i]
        _multiply(net.pair_input, seen.pair[b, p, t, j], room.hidden)
        total = np.float32(0)
        for i in range(len(room.hidden)):
            total += max(room.hidden[i], np.float32(0)) * net.pair_output[i]
        room.score[j] += total


@inner
def decide(
    episode: Episode, net: Net, keys: Keys[AnyArray], b: int, p: int, t: int, room: Room
) -> None:
    """Fill `log_p` with the log probabilities of the choices of an observation."""
    seen = episode.seen
    waypoints, width = keys.pair_key.shape[1], len(room.context)
    _copy(net.state_bias, room.inner)
    _multiply(net.state, seen.state[b, p, t], room.inner)
    _add_mean(episode, keys, b, p, t, room.inner)
    for i in range(width):
        room.inner[i] = max(room.inner[i], np.float32(0))
        room.context[i] = net.context_bias[i] + keys.graph[b, i]
    _multiply(net.context, room.inner, room.context)
    _glimpse(episode, keys, net.heads, b, p, t, room)
    _copy(room.context, room.glimpse)
    _multiply(net.glimpse_output, room.mixed, room.glimpse)
    room.query[:] = 0
    _multiply(net.query, room.glimpse, room.query)
    scale = np.float32(1 / math.sqrt(width))
    room.score[:] = 0
    for i in range(width):
        value = room.query[i] * scale
        for j in range(waypoints):
            room.score[j] += value * keys.pointer_key[b, i, j]
    _score_pairs(episode, net, keys, b, p, t, room)
    stop = np.float32(0)
    own = seen.node[b, p, t, seen.active[b, p, t]]
    for i in range(width):
        stop += room.query[i] * keys.stop_key[b, own, i]
    room.score[waypoints] = stop * scale + net.stop_bias
    highest = -np.inf
    for j in range(waypoints + 1):
        room.log_p[j] = -np.inf
        if seen.allowed[b, p, t, j]:
            room.log_p[j] = net.clip * math.tanh(room.score[j])
            highest = max(highest, room.log_p[j])
    total = 0.0
    for j in range(waypoints + 1):
        if seen.allowed[b, p, t, j]:
            total += math.exp(room.log_p[j] - highest)
    shift = highest + math.log(total)
    for j in range(waypoints + 1):
        room.log_p[j] -= shift


@inner
def _choose(log_p: AnyArray, chance: float) -> int:
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
def roll_out(episode: Episode, net: Net, keys: Keys[AnyArray], made: Choices, room: Room) -> None:
    """Whole rollouts of every problem; where an episode has room to see all steps, all are kept."""
    seen = episode.seen
    recorded = seen.active.shape[2] > 1
    for b in range(made.choices.shape[0]):
        for p in range(made.choices.shape[1]):
            for step in range(made.choices.shape[2]):
                t = step if recorded else 0
                if not recorded:
                    seen.pair[b, p, t] = 0
                    seen.state[b, p, t] = 0
                observe_one(episode, b, p, t)
                decide(episode, net, keys, b, p, t, room)
                choice = _choose(room.log_p, made.chances[b, p, step])
                made.choices[b, p, step] = choice
                made.uavs[b, p, step] = seen.active[b, p, t]
                made.likelihood[b, p] += room.log_p[choice]
                step_one(episode, b, p, t, choice)
