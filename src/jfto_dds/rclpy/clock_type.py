"""Kinds of clock."""

from __future__ import annotations

import enum


class ClockType(enum.IntEnum):
    """Kinds of clock, numbered as in rcl."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3
