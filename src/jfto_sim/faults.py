"""A bad link between vehicle and station: loss, delay, duplication, reordering, cuts; seeded."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError


@dataclass(frozen=True)
class LinkFaults:
    """What one direction of a link does to each frame.

    `loss`, `duplication` and `reordering` are probabilities; a reordered frame is held back by
    `reorder_s` more than the others. Delay is `delay_s` plus a uniform share of `jitter_s`.
    """

    loss: float = 0.0
    delay_s: float = 0.0
    jitter_s: float = 0.0
    duplication: float = 0.0
    reordering: float = 0.0
    reorder_s: float = 0.05
    cut: bool = False

    def __post_init__(self) -> None:
        for name in ("loss", "duplication", "reordering"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"link {name} is {getattr(self, name)}, must be within 0 to 1.")
        for name in ("delay_s", "jitter_s", "reorder_s"):
            if not getattr(self, name) >= 0.0:
                raise InputError(f"link {name} is {getattr(self, name)}, must not be negative.")


class LossyPipe:
    """One direction of a link. Frames go in with the time, and come out when they are due."""

    def __init__(self, faults: LinkFaults, seed: int) -> None:
        self.faults = faults
        self._rng = np.random.default_rng(seed)
        self._held: list[tuple[float, int, bytes]] = []
        self._count = 0
        self.lost = 0

    def put(self, frame: bytes, now_s: float) -> None:
        """Send a frame into the pipe."""
        faults = self.faults
        if faults.cut or (faults.loss and self._rng.random() < faults.loss):
            self.lost += 1
            return
        copies = 2 if faults.duplication and self._rng.random() < faults.duplication else 1
        for _ in range(copies):
            due = now_s + faults.delay_s
            if faults.jitter_s:
                due += faults.jitter_s * self._rng.random()
            if faults.reordering and self._rng.random() < faults.reordering:
                due += faults.reorder_s
            heapq.heappush(self._held, (due, self._count, frame))
            self._count += 1

    def take(self, now_s: float) -> list[bytes]:
        """Frames that have arrived by now."""
        arrived = []
        while self._held and self._held[0][0] <= now_s + 1e-9:
            arrived.append(heapq.heappop(self._held)[2])
        return arrived

    def next_s(self) -> float:
        """When the next frame arrives, infinite if none is under way."""
        return self._held[0][0] if self._held else float("inf")
