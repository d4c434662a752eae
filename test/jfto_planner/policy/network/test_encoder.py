"""The encoder against attention worked out by hand."""

from __future__ import annotations

import math

import torch

from jfto_planner.policy.network.encoder import AttentionLayer, Encoder
from support.policy_cases import SMALL, instances


@torch.no_grad()
def test_attention_matches_the_formula_node_by_node() -> None:
    """Each head is softmax(q·k / sqrt(d_k)) v over all nodes; heads are concatenated, then W_O."""
    torch.manual_seed(0)
    layer = AttentionLayer(8, 2, 16).double()
    nodes = torch.randn(1, 3, 8, dtype=torch.float64)
    result = layer.attention(nodes, torch.ones(1, 3, dtype=torch.bool))
    weight = layer.query_key_value.weight
    query, key, value = (weight[8 * part : 8 * part + 8] for part in range(3))
    for i in range(3):
        heads = []
        for head in (slice(0, 4), slice(4, 8)):
            q = query[head] @ nodes[0, i]
            scores = [float(q @ (key[head] @ nodes[0, j])) / math.sqrt(4) for j in range(3)]
            total = sum(math.exp(score) for score in scores)
            heads.append(
                sum(
                    math.exp(score) / total * (value[head] @ nodes[0, j])
                    for j, score in enumerate(scores)
                )
            )
        expected = layer.output.weight @ torch.cat(heads)
        torch.testing.assert_close(result[0, i], expected)


def test_graph_embedding_is_the_mean_of_the_nodes() -> None:
    """h̄ is the mean over the S + W final node embeddings (eq. final_EBD)."""
    batch = instances(3, 7, 4)
    encoder = Encoder(SMALL.width, SMALL.heads, SMALL.layers, SMALL.hidden).eval()
    nodes, graph, valid = encoder(batch)
    assert nodes.shape[1] == batch.starts.shape[1] + 7
    assert valid.all()
    torch.testing.assert_close(graph, nodes.mean(1))
