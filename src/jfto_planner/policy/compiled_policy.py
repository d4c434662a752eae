"""The trained policy without torch: the encoder in numpy, the decoder's steps compiled.

A companion computer that only plans needs neither torch's memory nor the seconds of its import.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jfto_planner.policy.kernel.arrays import View, empty_fleet, empty_view
from jfto_planner.policy.kernel.decode import Known, Net, Room, roll_out
from jfto_planner.policy.problems import Array, Problems
from jfto_planner.policy.shape import PolicyShape

# As in torch's BatchNorm1d.
NORM_EPSILON = 1e-5


@dataclass(frozen=True)
class Flown:
    """Outcome of P rollouts of each of B problems, as Rollouts; `view` has what was recorded."""

    choices: Array  # (B, P, T)
    uavs: Array  # (B, P, T)
    log_likelihood: Array  # (B, P)
    length: Array  # (B, P)
    misses: Array  # (B, P)
    late: Array  # (B, P)
    view: View


class CompiledPolicy:
    """Rollouts with the weights of a Policy, given by their names there."""

    def __init__(self, weights: Mapping[str, Array], shape: PolicyShape) -> None:
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

    def encode(self, problems: Problems) -> Known:
        """Projections of a batch's nodes, computed once for all steps and rollouts."""
        starts = problems.starts.shape[1]
        used = np.zeros((len(problems.starts), starts))
        for row, valid in zip(problems.start_of.T, problems.uav_valid.T, strict=True):
            used[np.arange(len(row)), row] += valid
        valid = np.concatenate([used > 0, problems.waypoint_valid], axis=1)
        scene = problems.global_features()[:, None]
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
        return Known(
            graph=self._linear("decoder.graph", graph),
            node_part=np.ascontiguousarray(part.reshape(*part.shape[:2], 4, -1)),
            glimpse_key=np.ascontiguousarray(key.transpose(0, 2, 1)),
            glimpse_value=np.ascontiguousarray(value),
            pointer_key=np.ascontiguousarray(pointer.transpose(0, 2, 1)),
            pair_key=self._linear("decoder.pair_key", waypoints),
            stop_key=self._linear("decoder.stop_key", nodes),
        )

    def roll_out(
        self,
        problems: Problems,
        rollouts: int = 1,
        *,
        chances: Array | None = None,
        known: Known | None = None,
        record: bool = False,
    ) -> Flown:
        """P rollouts of each problem, of the likeliest choices unless `chances` are given.

        `chances` (B, P, A + W) are uniform numbers from [0, 1) to sample with.

        `known` is what `encode` gave for the problems; `record` keeps the view of every step.
        """
        scene = problems.scene()
        known = known or self.encode(problems)
        count, uavs = scene.speed.shape
        waypoints = scene.waypoints.shape[1]
        shape = (count, rollouts, uavs + waypoints)
        if chances is None:
            chances = np.full(shape, -1.0)
        fleet = empty_fleet(scene, rollouts)
        view = empty_view(scene, rollouts, shape[2] if record else 1)
        choices, actors = np.zeros(shape, np.int64), np.zeros(shape, np.int64)
        likelihood = np.zeros(shape[:2])
        room = _room(known, waypoints, uavs)
        roll_out(scene, fleet, view, self.net, known, chances, choices, actors, likelihood, room)
        return Flown(choices, actors, likelihood, fleet.length, fleet.misses, fleet.late, view)

    def _layer(self, name: str, nodes: Array, valid: Array) -> Array:
        nodes = self._norm(f"{name}.norm_attention", nodes + self._attention(name, nodes, valid))
        hidden = np.maximum(self._linear(f"{name}.feed_forward.0", nodes), 0)
        fed = self._linear(f"{name}.feed_forward.2", hidden)
        return self._norm(f"{name}.norm_feed_forward", nodes + fed)

    def _attention(self, name: str, nodes: Array, valid: Array) -> Array:
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

    def _norm(self, name: str, nodes: Array) -> Array:
        part = {
            key: self.weights[f"{name}.norm.{key}"]
            for key in ("weight", "bias", "running_mean", "running_var")
        }
        scale = part["weight"] / np.sqrt(part["running_var"] + np.float32(NORM_EPSILON))
        return np.asarray((nodes - part["running_mean"]) * scale + part["bias"])

    def _linear(self, name: str, values: Array) -> Array:
        bias = self.weights.get(f"{name}.bias")
        flat = values.reshape(-1, values.shape[-1]) @ self.weights[f"{name}.weight"].T
        out = flat.reshape(*values.shape[:-1], -1)
        return np.ascontiguousarray(out if bias is None else out + bias)

    def _matrix(self, name: str) -> Array:
        return np.ascontiguousarray(self.weights[f"{name}.weight"].T)

    def _bias(self, name: str) -> Array:
        return self.weights[f"{name}.bias"]


def _with_scene(points: Array, scene: Array) -> Array:
    shape = (*points.shape[:2], scene.shape[-1])
    return np.concatenate([points, np.broadcast_to(scene, shape)], axis=-1)


def _room(known: Known, waypoints: int, uavs: int) -> Room:
    width, pair = known.graph.shape[-1], known.pair_key.shape[-1]

    def single(size: int) -> Array:
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
        places=np.zeros((uavs, 3)),
        degree=np.zeros(uavs, np.int64),
    )
