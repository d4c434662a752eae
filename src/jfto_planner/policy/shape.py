"""Sizes of the network."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PolicyShape:
    """Sizes of the network: D_H, H, N_TP, the feed-forward width and C."""

    width: int = 128
    heads: int = 8
    layers: int = 3
    hidden: int = 512
    clip: float = 10.0
