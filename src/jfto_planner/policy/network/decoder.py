"""The decoder: a glimpse and a single-head pointer over waypoints and stopping (eqs. pro, hc)."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

from jfto_planner.policy.features import PAIR_FEATURES, STATE_FEATURES
from jfto_planner.policy.kernel.decode import Keys
from jfto_planner.policy.observation import Observation
from jfto_planner.policy.problems import Problems

PAIR_WIDTH = 32


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
        self.node_part = nn.Linear(width, 4 * width, bias=False)
        self.state = nn.Linear(STATE_FEATURES, width)
        self.context = nn.Linear(width, width)
        self.projection = nn.Linear(width, 3 * width, bias=False)
        self.glimpse_output = nn.Linear(width, width, bias=False)
        self.query = nn.Linear(width, width, bias=False)
        self.stop_key = nn.Linear(width, width)
        # Stopping early leaves everything to the rest, so an untrained policy should rarely do it.
        self.stop_bias = nn.Parameter(torch.tensor(-0.4))
        self.pair_input = nn.Linear(PAIR_FEATURES, PAIR_WIDTH)
        self.pair_key = nn.Linear(width, PAIR_WIDTH, bias=False)
        self.pair_query = nn.Linear(width, PAIR_WIDTH, bias=False)
        self.pair_output = nn.Linear(PAIR_WIDTH, 1, bias=False)

    def prepare(self, nodes: Tensor, graph: Tensor, batch: Problems[Tensor]) -> Keys[Tensor]:
        """Projections of a batch's node embeddings, computed once for all steps and rollouts."""
        waypoints = nodes[:, batch.starts.shape[1] :]
        key, value, pointer = self.projection(waypoints).chunk(3, dim=-1)
        return Keys(
            graph=self.graph(graph),
            node_part=self.node_part(nodes).unflatten(-1, (4, -1)),
            glimpse_key=key.transpose(1, 2),
            glimpse_value=value,
            pointer_key=pointer.transpose(1, 2),
            pair_key=self.pair_key(waypoints),
            stop_key=self.stop_key(nodes),
            waypoint_valid=batch.waypoint_valid,
            uav_valid=batch.uav_valid,
        )

    def forward(self, keys: Keys[Tensor], seen: Observation[Tensor]) -> Tensor:
        """Log probabilities (B, P, W + 1) of the choices; the last is to stop."""
        own = seen.node.gather(-1, seen.active[..., None])
        context = self._context(keys, seen, own)
        glimpse = self._glimpse(keys, context, seen.visited)
        query = self.query(glimpse)
        scale = 1 / math.sqrt(query.shape[-1])
        waypoint = query @ keys.pointer_key * scale
        waypoint = waypoint + self._pair(keys, glimpse, seen.pair)
        stop = (query * _rows(keys.stop_key, own)).sum(-1, keepdim=True) * scale + self.stop_bias
        logits = self.clip * torch.tanh(torch.cat([waypoint, stop], dim=-1).float())
        return torch.log_softmax(logits.masked_fill(~seen.allowed, -torch.inf), dim=-1)

    def _context(self, keys: Keys[Tensor], seen: Observation[Tensor], own: Tensor) -> Tensor:
        """h_c (B, P, D)."""
        kind = keys.node_part.dtype
        starts = keys.node_part.shape[1] - seen.visited.shape[-1]
        taken, left, here, others = keys.node_part.unbind(2)
        real = keys.waypoint_valid[:, None]
        fleet = torch.zeros(*own.shape[:2], taken.shape[1], dtype=kind, device=own.device)
        uavs = keys.uav_valid[:, None].expand_as(seen.node).to(kind)
        fleet = fleet.scatter_add(-1, seen.node, uavs)
        inner = (
            _mean(taken[:, starts:], (seen.visited & real).to(kind))
            + _mean(left[:, starts:], (~seen.visited).to(kind))
            + _rows(here, own)
            + _mean(others, fleet)
            + self.state(seen.state)
        )
        return keys.graph[:, None] + self.context(torch.relu(inner))

    def _pair(self, keys: Keys[Tensor], glimpse: Tensor, pair: Tensor) -> Tensor:
        """Additive attention (B, P, W) over what relates the UAV to each waypoint."""
        hidden = self.pair_input(pair)
        hidden = hidden + self.pair_query(glimpse)[:, :, None] + keys.pair_key[:, None]
        return self.pair_output(torch.relu(hidden)).squeeze(-1)

    def _glimpse(self, keys: Keys[Tensor], context: Tensor, visited: Tensor) -> Tensor:
        """Multi-head attention of the context over unvisited waypoints, (B, P, D)."""
        # With nothing left to visit, attend to everything rather than divide by zero.
        mask = visited & ~visited.all(-1, keepdim=True)

        def heads(tensor: Tensor) -> Tensor:
            return tensor.unflatten(-1, (self.heads, -1)).transpose(1, 2)

        query, key = heads(context), heads(keys.glimpse_key.transpose(1, 2))
        # Spelt out, since torch's fused attention is slower on CPUs at 16 numbers per head.
        score = query @ key.transpose(-1, -2) / math.sqrt(key.shape[-1])
        weight = score.masked_fill(mask[:, None], -torch.inf).softmax(-1)
        mixed = weight @ heads(keys.glimpse_value)
        return context + self.glimpse_output(mixed.transpose(1, 2).flatten(2))


def _mean(nodes: Tensor, weights: Tensor) -> Tensor:
    """Weighted mean of node embeddings (B, M, D) with weights (B, P, M)."""
    return (weights / weights.sum(-1, keepdim=True).clamp(min=1)) @ nodes


def _rows(nodes: Tensor, index: Tensor) -> Tensor:
    """Embeddings (B, P, D) of the nodes at (B, P, 1)."""
    return nodes.gather(1, index.expand(-1, -1, nodes.shape[-1]))
