"""From a point on the ground to a camera position that a UAV can take."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_planner.coverage.settings import CoverageSettings
from jfto_world.terrain import Dem

# What is tried, in this order, when the place on the normal will not do: first turning the line of
# sight towards the vertical at the same distance (shares of the angle between), then going away.
_TURNS = (0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0)
_STRETCHES = (1.0, 1.15, 1.3, 1.5)


@dataclass(frozen=True)
class Aim:
    """Camera positions and directions for a set of targets, arrays of length W.

    `reason` says why a place on the normal was not taken, "" where it was; where `possible` is
    False none was found. `wished_m` is the place on the normal.
    """

    position_m: Array
    wished_m: Array
    yaw_deg: Array
    pitch_deg: Array
    possible: Flags
    reason: tuple[str, ...]


def aim(
    dem: Dem,
    target_m: Array,
    normal: Array,
    distance_m: float,
    heading_deg: float,
    settings: CoverageSettings,
) -> Aim:
    """Positions at `distance_m` along `normal` (W, 3) from `target_m` (W, 3), looking back.

    Ground flatter than `settings.level_below_deg` is looked at from straight above, the image's
    upper edge towards `heading_deg`. Where the gimbal cannot point so, the place is outside of the
    terrain, too low, or does not see its target, the nearest alternative is taken.
    """
    level = normal[:, 2] >= np.cos(np.radians(settings.level_below_deg))
    yaw_deg = np.where(
        level, heading_deg, np.degrees(np.arctan2(-normal[:, 0], -normal[:, 1])) % 360.0
    )
    wished_deg = np.where(level, 90.0, np.degrees(np.arcsin(np.clip(normal[:, 2], -1, 1))))
    low, high = -settings.gimbal_pitch_max_deg, -settings.gimbal_pitch_min_deg
    clamped_deg = np.clip(wished_deg, low, high)

    elevation_deg = clamped_deg.copy()
    position = _position(target_m, yaw_deg, elevation_deg, distance_m)
    fault = _faults(dem, position, target_m, settings)
    reason = [
        found or ("the gimbal does not pitch so far" if wish != got else "")
        for found, wish, got in zip(fault, wished_deg, clamped_deg, strict=True)
    ]
    open_ = np.array([bool(found) for found in fault])
    for stretch in _STRETCHES:
        for turn in _TURNS:
            if not open_.any():
                break
            which = np.flatnonzero(open_)
            tried_deg = clamped_deg[which] + turn * (high - clamped_deg[which])
            tried = _position(target_m[which], yaw_deg[which], tried_deg, stretch * distance_m)
            good = np.array([not found for found in _faults(dem, tried, target_m[which], settings)])
            position[which[good]] = tried[good]
            elevation_deg[which[good]] = tried_deg[good]
            open_[which[good]] = False
    wished = target_m + distance_m * np.where(level[:, None], [0.0, 0.0, 1.0], normal)
    return Aim(position, wished, yaw_deg, -elevation_deg, ~open_, tuple(reason))


def _position(target_m: Array, yaw_deg: Array, elevation_deg: Array, distance_m: float) -> Array:
    """Where a camera stands that looks at its target with this yaw and this angle downwards."""
    yaw, down = np.radians(yaw_deg), np.radians(elevation_deg)
    look = np.stack([np.sin(yaw) * np.cos(down), np.cos(yaw) * np.cos(down), -np.sin(down)], -1)
    return target_m - distance_m * look


def _faults(dem: Dem, position_m: Array, target_m: Array, settings: CoverageSettings) -> list[str]:
    """Why each position cannot be taken; "" where it can."""
    inside = dem.contains(position_m[:, 0], position_m[:, 1])
    height = np.full(len(position_m), -np.inf)
    height[inside] = height_above_ground(dem, position_m[inside], settings.clearance_radius_m)
    high_enough = height >= settings.min_height_m
    sees = np.zeros(len(position_m), dtype=bool)
    able = inside & high_enough
    ground = target_m[able].copy()
    ground[:, 2] = dem.height(ground[:, 0], ground[:, 1])
    sees[able] = dem.sees(position_m[able], ground)
    return [
        "it would be outside of the terrain's margin"
        if not in_
        else f"it would be {metres:.0f} m above the ground near it"
        if not up
        else "the ground would hide its target"
        if not clear
        else ""
        for in_, metres, up, clear in zip(inside, height, high_enough, sees, strict=True)
    ]


def height_above_ground(dem: Dem, position_m: Array, radius_m: float) -> Array:
    """Height in metres of positions (W, 3) above the highest top within `radius_m`."""
    angle = np.arange(16) * (np.pi / 8)
    ring = np.linspace(0.0, radius_m, 5)[1:, None]
    around_x = np.concatenate([[0.0], (ring * np.cos(angle)).ravel()])
    around_y = np.concatenate([[0.0], (ring * np.sin(angle)).ravel()])
    x = position_m[:, 0, None] + around_x
    y = position_m[:, 1, None] + around_y
    known = dem.contains(x, y)
    ground = np.full(x.shape, -np.inf)
    ground[known] = dem.top_height(x[known], y[known])
    return position_m[:, 2] - ground.max(axis=1)
