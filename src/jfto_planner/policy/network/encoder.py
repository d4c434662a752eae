"""The encoder: attention layers over starts and waypoints (eqs. h_hat, hl, final_EBD)."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

from jfto_planner.policy.features import GLOBAL_FEATURES
from jfto_planner.policy.problems import Problems, global_features


class NodeNorm(nn.Module):
    """Batch normalisation over all real nodes; padding takes no part."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.norm = nn.BatchNorm1d(width)

    def forward(self, nodes: Tensor, valid: Tensor) -> Tensor:
        """Normalise (B, M, D) where `valid` (B, M)."""
        if bool(valid.all()):
            return self.norm(nodes.flatten(0, 1)).view_as(nodes)
        out = torch.zeros_like(nodes)
        out[valid] = self.norm(nodes[valid])
        return out


class AttentionLayer(nn.Module):
    """Multi-head attention and feed-forward, each with a residual and batch normalisation."""

    def __init__(self, width: int, heads: int, hidden: int) -> None:
        super().__init__()
        self.heads = heads
        self.query_key_value = nn.Linear(width, 3 * width, bias=False)
        self.output = nn.Linear(width, width, bias=False)
        self.norm_attention = NodeNorm(width)
        self.feed_forward = nn.Sequential(
            nn.Linear(width, hidden), nn.ReLU(), nn.Linear(hidden, width)
        )
        self.norm_feed_forward = NodeNorm(width)

    def forward(self, nodes: Tensor, valid: Tensor) -> Tensor:
        """Embeddings (B, M, D) of the next layer; `valid` (B, M) marks real nodes."""
        nodes = self.norm_attention(nodes + self.attention(nodes, valid), valid)
        return self.norm_feed_forward(nodes + self.feed_forward(nodes), valid)

    def attention(self, nodes: Tensor, valid: Tensor) -> Tensor:
        """Self attention of H heads, every node over all real nodes."""
        batch, count, width = nodes.shape
        split = self.query_key_value(nodes).view(batch, count, 3, self.heads, -1)
        query, key, value = split.permute(2, 0, 3, 1, 4)
        # Spelt out, since torch's fused attention is slower on CPUs at 16 numbers per head.
        score = query @ key.transpose(-1, -2) / math.sqrt(key.shape[-1])
        mixed = score.masked_fill(~valid[:, None, None], -torch.inf).softmax(-1) @ value
        return self.output(mixed.transpose(1, 2).reshape(batch, count, width))


class Encoder(nn.Module):
    """Node embeddings (B, S + W, D), starts first, and their mean, the graph embedding (B, D)."""

    def __init__(self, width: int, heads: int, layers: int, hidden: int) -> None:
        super().__init__()
        self.start = nn.Linear(3 + GLOBAL_FEATURES, width)
        self.waypoint = nn.Linear(3 + GLOBAL_FEATURES, width)
        self.layers = nn.ModuleList(AttentionLayer(width, heads, hidden) for _ in range(layers))

    def forward(self, batch: Problems[Tensor]) -> tuple[Tensor, Tensor, Tensor]:
        """Node embeddings, graph embedding and which nodes are real, of a batch."""
        scene = torch.from_numpy(global_features(batch.numpy()))
        scene = scene.to(batch.waypoints.device)[:, None]
        start_valid = _used_starts(batch)
        valid = torch.cat([start_valid, batch.waypoint_valid], dim=1)
        nodes = torch.cat(
            [
                self.start(_with_scene(batch.starts, scene)),
                self.waypoint(_with_scene(batch.waypoints, scene)),
            ],
            dim=1,
        )
        for layer in self.layers:
            nodes = layer(nodes, valid)
        nodes = nodes * valid[..., None]
        return nodes, nodes.sum(1) / valid.sum(1, keepdim=True), valid


def _with_scene(points: Tensor, scene: Tensor) -> Tensor:
    return torch.cat([points, scene.expand(-1, points.shape[1], -1)], dim=-1)


def _used_starts(batch: Problems[Tensor]) -> Tensor:
    """Start nodes (B, S) at which at least one real UAV stands: the others are padding."""
    used = batch.starts.new_zeros(batch.starts.shape[:2])
    return used.scatter_add(1, batch.start_of, batch.uav_valid.to(used.dtype)) > 0
