"""When things happened: the vehicles' time of what was recorded, and when their flight began."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from jfto.analysis.motion import motions
from jfto_msgs_py.records.plan import Plan

# This far above its pad a UAV has surely left it, whatever the noise.
_UP_M = 2.0

Sample = tuple[int, tuple[float, float, float]]


class TimeMap:
    """From the recorder's clock to the vehicles', which runs faster in a simulation.

    Learned from messages that carry a stamp: when each was received, and what it says.

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


def seen_lift_off_ns(poses: Mapping[str, Sequence[Sample]], plan: Plan) -> int | None:
    """Time zero of the plan by the middle one of all UAVs, None where none was seen to climb.

    `poses` are (stamp in ns since the epoch, ENU metres). Each UAV's climb is held against the
    planned one.
    """
    found = []
    for uav, motion in zip(plan.uavs, motions(plan), strict=True):
        samples = sorted(poses.get(uav.id, []))
        heights = np.array([place[2] for _, place in samples])
        planned = motion.position_m[:, 2] - motion.position_m[0, 2]
        if not heights.size or heights[0] - uav.start_m[2] > _UP_M or planned.max() < _UP_M:
            # The record begins in the air.
            continue
        up = heights - heights[0] >= _UP_M
        if up.any():
            planned_s = float(motion.times_s[np.argmax(planned >= _UP_M)])
            found.append(samples[int(np.argmax(up))][0] - round(planned_s * 1e9))
    return int(np.median(found)) if found else None
