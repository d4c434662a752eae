"""What a fleet learns about its channel from the levels that it receives."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array
from jfto_msgs_py.units import ratio_to_db
from jfto_world.radio.channel import Channel

# Nearer pairs say more about antennas and position errors than about the path.
_LEAST_M = 100.0
# As much as one link that loses just what was planned.
_PRIOR_WEIGHT = 1.0


class LossEstimate:
    """Mean and spread of what links lose beyond a channel's loss, with exponential forgetting.

    Every pair heard is one observation: measured gain against the channel's at the measured
    distance. What is `memory_s` seconds old counts 1/e. A prior of one link at 0 dB keeps a single
    odd measurement from steering the fleet. Only pairs that hear each other are seen, so where
    shadowing is strong and links are scarce the mean comes out too low.
    """

    def __init__(self, channel: Channel, memory_s: float = 60.0) -> None:
        self._channel = channel
        self._memory_s = memory_s
        self._weight = self._sum = self._squares = 0.0
        self._stamp_ns: int | None = None

    @property
    def loss_db(self) -> float:
        """Mean loss beyond the channel's, dB; 0 as long as nothing was heard."""
        return self._sum / (self._weight + _PRIOR_WEIGHT)

    @property
    def spread_db(self) -> float:
        """Standard deviation of single links about the mean, dB; 0 before anything was heard."""
        if self._weight == 0:
            return 0.0
        mean = self._sum / self._weight
        return float(np.sqrt(max(self._squares / self._weight - mean**2, 0.0)))

    def take(self, stamp_ns: int, gain: Array, positions_m: Array) -> None:
        """Learn from gains (A, A), 0 where nothing is heard, at measured positions (A, 3), metres.

        Measurements that are not newer than the last ones are passed over.
        """
        if self._stamp_ns is not None and stamp_ns <= self._stamp_ns:
            return
        if self._stamp_ns is not None:
            kept = float(np.exp((self._stamp_ns - stamp_ns) / 1e9 / self._memory_s))
            self._weight, self._sum = kept * self._weight, kept * self._sum
            self._squares *= kept
        self._stamp_ns = stamp_ns
        first, second = np.triu_indices(len(positions_m), 1)
        distance_m = np.linalg.norm(positions_m[first] - positions_m[second], axis=1)
        # A channel is reciprocal; one direction may be heard where the other is not.
        heard = np.maximum(gain[first, second], gain[second, first])
        seen = (heard > 0) & (distance_m >= _LEAST_M)
        loss_db = ratio_to_db(self._channel.gain(distance_m[seen]) / heard[seen])
        self._weight += float(seen.sum())
        self._sum += float(loss_db.sum())
        self._squares += float((loss_db**2).sum())
