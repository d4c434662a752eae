"""When a flight began, seen from where the UAVs were."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from jfto.analysis.motion import flown
from jfto_msgs_py.plan import Plan

# This far above its pad a UAV has surely left it, whatever the noise.
_UP_M = 2.0

Sample = tuple[int, tuple[float, float, float]]


def seen_lift_off_ns(poses: Mapping[str, Sequence[Sample]], plan: Plan) -> int | None:
    """Time zero of the plan by the middle one of all UAVs, None where none was seen to climb.

    `poses` are (stamp in ns since the epoch, ENU metres). Each UAV's climb is held against the
    planned one.
    """
    found = []
    for uav, motion in zip(plan.uavs, flown(plan), strict=True):
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
