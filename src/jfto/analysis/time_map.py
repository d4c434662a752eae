"""From the recorder's clock to the vehicles', which runs faster in a simulation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


class TimeMap:
    """Learned from messages that carry a stamp: when each was received, and what it says.

    Both are ns since the epoch. What has no stamp of its own was sent when it was received, less
    a delay that all messages share.
    """

    def __init__(self, received_ns: Sequence[int], stamped_ns: Sequence[int]) -> None:
        order = np.argsort(np.asarray(received_ns, dtype=np.int64), kind="stable")
        received = np.asarray(received_ns, dtype=np.int64)[order]
        stamped = np.asarray(stamped_ns, dtype=np.int64)[order]
        self._known = received.size > 0
        if not self._known:
            return
        # Late messages of one vehicle must not set the time of all back.
        stamped = np.maximum.accumulate(stamped)
        received, first = np.unique(received, return_index=True)
        self._origin = int(received[0]), int(stamped[first[0]])
        self._received = (received - self._origin[0]).astype(np.float64)
        self._stamped = (stamped[first] - self._origin[1]).astype(np.float64)
        span = self._received[-1]
        self._pace = float(self._stamped[-1] / span) if span > 0 else 1.0

    def vehicles_ns(self, received_ns: NDArray[np.int64]) -> NDArray[np.int64]:
        """Vehicles' time of moments of the recorder; beyond what is known, at the mean pace."""
        if not self._known:
            return received_ns
        at = (received_ns - self._origin[0]).astype(np.float64)
        inside = np.interp(at, self._received, self._stamped)
        before = np.minimum(at, 0.0) * self._pace
        after = np.maximum(at - self._received[-1], 0.0) * self._pace
        return np.asarray(self._origin[1] + np.rint(inside + before + after).astype(np.int64))
