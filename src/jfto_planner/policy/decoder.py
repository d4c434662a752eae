"""The decoder: a glimpse and a single-head pointer over waypoints and stopping (eqs. pro, hc)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from jfto_planner.policy.environment import STATE_FEATURES, Episode, Observation

PAIR_FEATURES = 4


@dataclass(frozen=True)
class Keys:
    """What stays the same over all steps of a batch: projections of the node embeddings."""

    nodes: Tensor  # (B, S + W, D)
    graph: Tensor  # (B, 1, D)
    glimpse_key: Tensor  # (B, H, W, D / H)
    glimpse_value: Tensor  # (B, H, W, D / H)
    pointer_key: Tensor  # (B, W, D)


class Decoder(nn.Module):
    """Logits of the next choice from the context embedding h_c (eq. hc).

    The context joins the graph embedding with the mean embeddings of allocated and unallocated
    waypoints, the nodes where the choosing UAV and the others are, and T and K as scalars. To the
    pointer's compatibility a small network adds what relates the UAV to each waypoint directly
    (distance, distance from rivals, time left): a point that the printed attention leaves to be
    learned from coordinates.
    """

    def __init__(self, width: int, heads: int, clip: float) -> None:
        super().__init__()
        self.heads = heads
        self.clip = clip
        self.graph = nn.Linear(width, width, bias=False)
        self.context = nn.Sequential(
            nn.Linear(4 * width + STATE_FEATURES, width), nn.ReLU(), nn.Linear(width, width)
        )
        self.projection = nn.Linear(width, 3 * width, bias=False)
        self.glimpse_output = nn.Linear(width, width, bias=False)
        self.query = nn.Linear(width, width, bias=False)
        self.stop_key = nn.Linear(width, width)
        # Stopping early leaves everything to the rest, so an untrained policy should rarely do it.
        self.stop_bias = nn.Parameter(torch.tensor(-0.4))
        self.pair = nn.Sequential(nn.Linear(PAIR_FEATURES, 16), nn.ReLU(), nn.Linear(16, 1))

    def prepare(self, nodes: Tensor, graph: Tensor, starts: int) -> Keys:
        """Projections of a batch's node embeddings, computed once for all steps and rollouts."""
        waypoints = nodes[:, starts:]
        batch, count, width = waypoints.shape
        key, value, pointer = self.projection(waypoints).chunk(3, dim=-1)

        def heads(tensor: Tensor) -> Tensor:
            return tensor.view(batch, count, self.heads, width // self.heads).transpose(1, 2)

        return Keys(nodes, self.graph(graph)[:, None], heads(key), heads(value), pointer)

    def forward(self, keys: Keys, episode: Episode, seen: Observation) -> Tensor:
        """Log probabilities (B, P, W + 1) of the choices; the last is to stop."""
        context = self._context(keys, episode, seen)
        glimpse = self._glimpse(keys, context, episode)
        query = self.query(glimpse)
        scale = 1 / math.sqrt(query.shape[-1])
        waypoint = query @ keys.pointer_key.transpose(1, 2) * scale
        waypoint = waypoint + self.pair(seen.pair).squeeze(-1)
        own = _node_of(keys.nodes, seen.node, seen.active)
        stop = (query * self.stop_key(own)).sum(-1, keepdim=True) * scale + self.stop_bias
        logits = self.clip * torch.tanh(torch.cat([waypoint, stop], dim=-1))
        logits = logits.masked_fill(~seen.allowed, -torch.inf)
        return torch.log_softmax(logits.float(), dim=-1)

    def _context(self, keys: Keys, episode: Episode, seen: Observation) -> Tensor:
        """h_c (B, P, D)."""
        starts = keys.nodes.shape[1] - episode.visited.shape[-1]
        waypoints = keys.nodes[:, starts:]
        real = episode.batch.waypoint_valid[:, None]
        left = _mean(waypoints, (~episode.visited).to(waypoints.dtype))
        taken = _mean(waypoints, (episode.visited & real).to(waypoints.dtype))
        own = _node_of(keys.nodes, seen.node, seen.active)
        fleet = torch.zeros(
            *seen.node.shape[:2], keys.nodes.shape[1], dtype=keys.nodes.dtype, device=own.device
        )
        uavs = episode.batch.uav_valid[:, None].expand_as(seen.node).to(fleet.dtype)
        fleet = fleet.scatter_add(-1, seen.node, uavs)
        others = _mean(keys.nodes, fleet)
        parts = torch.cat([taken, left, own, others, seen.state.to(own.dtype)], dim=-1)
        return keys.graph + self.context(parts)

    def _glimpse(self, keys: Keys, context: Tensor, episode: Episode) -> Tensor:
        """Multi-head attention of the context over unvisited waypoints, (B, P, D)."""
        batch, rollouts, width = context.shape
        query = context.view(batch, rollouts, self.heads, -1).transpose(1, 2)
        mask = ~episode.visited
        # With nothing left to visit, attend to everything rather than divide by zero.
        mask = (mask | ~mask.any(-1, keepdim=True))[:, None]
        mixed = nn.functional.scaled_dot_product_attention(
            query, keys.glimpse_key, keys.glimpse_value, attn_mask=mask
        )
        return context + self.glimpse_output(mixed.transpose(1, 2).reshape(batch, rollouts, width))


def _mean(nodes: Tensor, weights: Tensor) -> Tensor:
    """Weighted mean of node embeddings (B, M, D) with weights (B, P, M)."""
    return weights @ nodes / weights.sum(-1, keepdim=True).clamp(min=1)


def _node_of(nodes: Tensor, node: Tensor, active: Tensor) -> Tensor:
    """Embedding (B, P, D) of the node that the active UAV is at."""
    index = node.gather(-1, active[..., None])
    return nodes.gather(1, index.expand(-1, -1, nodes.shape[-1]))
