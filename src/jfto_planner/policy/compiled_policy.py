"""The trained policy without torch: the encoder in numpy, the decoder's steps compiled.

A companion computer that only plans needs neither torch's memory nor the seconds of its import.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Generic

import numpy as np

from jfto_msgs_py.types import AnyArray
from jfto_planner.policy.kernel.decode import Choices, Column, Keys, Net, Room, roll_out
from jfto_planner.policy.kernel.episode import new_episode
from jfto_planner.policy.observation import Observation
from jfto_planner.policy.problems import Problems, global_features

# As in torch's BatchNorm1d.
NORM_EPSILON = 1e-5


@dataclass(frozen=True)
class PolicyShape:
    """Sizes of the network: D_H, H, N_TP, the feed-forward width and C."""

    width: int = 128
    heads: int = 8
    layers: int = 3
    hidden: int = 512
    clip: float = 10.0


@dataclass(frozen=True)
class Rollouts(Generic[Column]):
    """Outcome of P rollouts of each of B problems, as arrays or tensors.

    `choices` and `uavs` (B, P, T) say who chose what (W = stop); `log_likelihood`, `length`
    (extents), `misses` and `late` are (B, P). `seen` is what the choices were based on, as far as
    it was recorded.
    """

    choices: Column
    uavs: Column
    log_likelihood: Column
    length: Column
    misses: Column
    late: Column
    seen: Observation[Column]

    def cost(self, miss_penalty: float, late_penalty: float) -> Column:
        """What training minimises: length plus penalties for broken rules, (B, P)."""
        columns: Any = self
        cost: Column = columns.length + miss_penalty * columns.misses + late_penalty * columns.late
        return cost


class CompiledPolicy:
    """Rollouts with the weights of a Policy, given by their names there."""

    def __init__(self, weights: Mapping[str, AnyArray], shape: PolicyShape) -> None:
        self.weights, self.shape = weights, shape
        self.net = Net(
            state=self._matrix("decoder.state"),
            state_bias=self._bias("decoder.state"),
            context=self._matrix("decoder.context"),
            context_bias=self._bias("decoder.context"),
            glimpse_output=self._matrix("decoder.glimpse_output"),
            query=self._matrix("decoder.query"),
            pair_input=self._matrix("decoder.pair_input"),
            pair_bias=self._bias("decoder.pair_input"),
            pair_query=self._matrix("decoder.pair_query"),
            pair_output=np.ascontiguousarray(self._matrix("decoder.pair_output")[:, 0]),
            stop_bias=float(weights["decoder.stop_bias"]),
            heads=shape.heads,
            clip=float(shape.clip),
        )

    def encode(self, problems: Problems[AnyArray]) -> Keys[AnyArray]:
        """Projections of a batch's nodes, computed once for all steps and rollouts."""
        starts = problems.starts.shape[1]
        used = np.zeros((len(problems.starts), starts))
        for row, valid in zip(problems.start_of.T, problems.uav_valid.T, strict=True):
            used[np.arange(len(row)), row] += valid
        valid = np.concatenate([used > 0, problems.waypoint_valid], axis=1)
        scene = global_features(problems)[:, None]
        nodes = np.concatenate(
            [
                self._linear("encoder.start", _with_scene(problems.starts, scene)),
                self._linear("encoder.waypoint", _with_scene(problems.waypoints, scene)),
            ],
            axis=1,
        )
        for number in range(self.shape.layers):
            nodes = self._layer(f"encoder.layers.{number}", nodes, valid)
        nodes *= valid[..., None]
        graph = nodes.sum(1) / valid.sum(1, keepdims=True).astype(np.float32)
        waypoints = nodes[:, starts:]
        key, value, pointer = np.split(self._linear("decoder.projection", waypoints), 3, axis=-1)
        part = self._linear("decoder.node_part", nodes)
        return Keys(
            graph=self._linear("decoder.graph", graph),
            node_part=np.ascontiguousarray(part.reshape(*part.shape[:2], 4, -1)),
            glimpse_key=np.ascontiguousarray(key.transpose(0, 2, 1)),
            glimpse_value=np.ascontiguousarray(value),
            pointer_key=np.ascontiguousarray(pointer.transpose(0, 2, 1)),
            pair_key=self._linear("decoder.pair_key", waypoints),
            stop_key=self._linear("decoder.stop_key", nodes),
            waypoint_valid=problems.waypoint_valid,
            uav_valid=problems.uav_valid,
        )

    def roll_out(
        self,
        problems: Problems[AnyArray],
        rollouts: int = 1,
        *,
        chances: AnyArray | None = None,
        keys: Keys[AnyArray] | None = None,
        record: bool = False,
    ) -> Rollouts[AnyArray]:
        """P rollouts of each problem, of the likeliest choices unless `chances` are given.

        `chances` (B, P, A + W) are uniform numbers from [0, 1) to sample with. `keys` are what
        `encode` gave for the problems; `record` keeps what was seen at every step.
        """
        keys = keys or self.encode(problems)
        episode = new_episode(problems, rollouts, recorded=record)
        count, uavs = problems.speed.shape
        waypoints = problems.waypoints.shape[1]
        shape = (count, rollouts, uavs + waypoints)
        made = Choices(
            chances=np.full(shape, -1.0) if chances is None else chances,
            choices=np.zeros(shape, np.int64),
            uavs=np.zeros(shape, np.int64),
            likelihood=np.zeros(shape[:2]),
        )
        roll_out(episode, self.net, keys, made, _room(keys, waypoints))
        return Rollouts(
            made.choices, made.uavs, made.likelihood, episode.length, episode.misses,
            episode.late, episode.seen,
        )  # fmt: skip

    def _layer(self, name: str, nodes: AnyArray, valid: AnyArray) -> AnyArray:
        nodes = self._norm(f"{name}.norm_attention", nodes + self._attention(name, nodes, valid))
        hidden = np.maximum(self._linear(f"{name}.feed_forward.0", nodes), 0)
        fed = self._linear(f"{name}.feed_forward.2", hidden)
        return self._norm(f"{name}.norm_feed_forward", nodes + fed)

    def _attention(self, name: str, nodes: AnyArray, valid: AnyArray) -> AnyArray:
        batch, count, width = nodes.shape
        split = self._linear(f"{name}.query_key_value", nodes)
        split = split.reshape(batch, count, 3, self.shape.heads, -1).transpose(2, 0, 3, 1, 4)
        query, key, value = split
        score = query @ key.swapaxes(-1, -2) * np.float32(1 / math.sqrt(width // self.shape.heads))
        score[~np.broadcast_to(valid[:, None, None], score.shape)] = -np.inf
        score -= score.max(-1, keepdims=True)
        weight = np.exp(score, out=score)
        weight /= weight.sum(-1, keepdims=True)
        mixed = (weight @ value).transpose(0, 2, 1, 3).reshape(batch, count, width)
        return self._linear(f"{name}.output", mixed)

    def _norm(self, name: str, nodes: AnyArray) -> AnyArray:
        part = {
            key: self.weights[f"{name}.norm.{key}"]
            for key in ("weight", "bias", "running_mean", "running_var")
        }
        scale = part["weight"] / np.sqrt(part["running_var"] + np.float32(NORM_EPSILON))
        return np.asarray((nodes - part["running_mean"]) * scale + part["bias"])

    def _linear(self, name: str, values: AnyArray) -> AnyArray:
        bias = self.weights.get(f"{name}.bias")
        flat = values.reshape(-1, values.shape[-1]) @ self.weights[f"{name}.weight"].T
        out = flat.reshape(*values.shape[:-1], -1)
        return np.ascontiguousarray(out if bias is None else out + bias)

    def _matrix(self, name: str) -> AnyArray:
        return np.ascontiguousarray(self.weights[f"{name}.weight"].T)

    def _bias(self, name: str) -> AnyArray:
        return self.weights[f"{name}.bias"]


def _with_scene(points: AnyArray, scene: AnyArray) -> AnyArray:
    shape = (*points.shape[:2], scene.shape[-1])
    return np.concatenate([points, np.broadcast_to(scene, shape)], axis=-1)


def _room(keys: Keys[AnyArray], waypoints: int) -> Room:
    width, pair = keys.graph.shape[-1], keys.pair_key.shape[-1]

    def single(size: int) -> AnyArray:
        return np.zeros(size, np.float32)

    return Room(
        inner=single(width),
        context=single(width),
        mixed=single(width),
        glimpse=single(width),
        query=single(width),
        pair=single(pair),
        hidden=single(pair),
        score=single(waypoints + 1),
        log_p=single(waypoints + 1),
    )
