"""One straight leg of the waypoint planner, whose speed may be changed while it is flown."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.types import Array
from jfto_world.motion.arducopter.leg_profile import (
    ACCEL,
    COLUMNS,
    DURATION,
    JERK,
    LENGTH,
    SPEED,
    T_2,
    T_4,
    T_ACC,
    T_J,
    fill_leg,
    solve_speed_up,
    speed_up,
)

Vector = tuple[float, float, float]


@dataclass
class _Stage:
    """From `begin_s` on: base + speed · t + sign · (a speed-up profile)."""

    begin_s: float
    base_m: float
    speed_mps: float
    sign: float
    profile: Array


def _profile(leg: Array, speed_mps: float, accel_mps2: float, limits: Array, room: float) -> Array:
    """A speed-up row like the leg's own, for another speed."""
    reached, peak, jerk, t_j, t_2, t_4 = solve_speed_up(
        speed_mps, accel_mps2, limits[5], limits[6], room
    )
    row = leg.copy()
    row[SPEED], row[ACCEL], row[JERK] = reached, peak, jerk
    row[T_J], row[T_2], row[T_4] = t_j, t_2, t_4
    row[T_ACC] = 4.0 * t_j + 2.0 * t_2 + t_4
    return row


class Leg:
    """Motion of the target from `origin` to `destination`, from rest to rest.

    `entry` and `exit` are the rows of `leg_profile` that describe its speed-up and its braking;
    they differ once the speed has been changed on the way.
    """

    def __init__(self, origin: Vector, destination: Vector, limits: Array) -> None:
        self.origin, self.destination = origin, destination
        self.limits = limits
        row = np.zeros(COLUMNS)
        step = [destination[k] - origin[k] for k in range(3)]
        fill_leg(row, step[0], step[1], step[2], limits)
        self.entry, self.exit = row, row
        self.unit: Vector = (float(row[0]), float(row[1]), float(row[2]))
        self.length_m = float(row[LENGTH])
        self.elapsed_s = 0.0
        self._stages: list[_Stage] = []
        self._brake_s = 0.0
        self.duration_s = 0.0
        self._lay([_Stage(0.0, 0.0, 0.0, 1.0, row)], row)

    def _lay(self, stages: list[_Stage], brake: Array) -> None:
        """Set the stages before the braking, and the braking after the last one."""
        self._stages, self.exit = stages, brake
        self.duration_s = 0.0
        if self.length_m <= 0.0:
            return
        last = stages[-1]
        settled_s = last.begin_s + float(last.profile[T_ACC])
        at_m = self._along(last, settled_s)[0]
        speed = float(brake[SPEED])
        brake_m = 0.5 * speed * float(brake[T_ACC])
        self._brake_s = settled_s + max(0.0, self.length_m - at_m - brake_m) / speed
        self.duration_s = self._brake_s + float(brake[T_ACC])
        self.exit = brake.copy()
        self.exit[DURATION] = self.duration_s

    @staticmethod
    def _along(stage: _Stage, time_s: float) -> tuple[float, float, float]:
        after = time_s - stage.begin_s
        x, w, a = speed_up(stage.profile, after)
        sign = stage.sign
        return (
            stage.base_m + stage.speed_mps * after + sign * x,
            stage.speed_mps + sign * w,
            sign * a,
        )

    def along(self, time_s: float) -> tuple[float, float, float]:
        """Distance, speed and acceleration along the leg at a time since it began."""
        if time_s <= 0.0 or self.length_m <= 0.0:
            return 0.0, 0.0, 0.0
        if time_s >= self.duration_s:
            return self.length_m, 0.0, 0.0
        if time_s > self._brake_s:
            x, w, a = speed_up(self.exit, self.duration_s - time_s)
            return self.length_m - x, w, -a
        stage = self._stages[0]
        for later in self._stages[1:]:
            if time_s >= later.begin_s:
                stage = later
        return self._along(stage, time_s)

    @property
    def remaining_s(self) -> float:
        """Planner time to the end of the leg."""
        return self.duration_s - self.elapsed_s

    def change_limits(self, limits: Array) -> None:
        """Take new speed limits on the leg in progress; its accelerations stay as they were."""
        row = np.zeros(COLUMNS)
        step = [self.destination[k] - self.origin[k] for k in range(3)]
        fill_leg(row, step[0], step[1], step[2], limits)
        self.limits = limits
        if self.length_m <= 0.0 or math.isclose(row[5], self.entry[5], rel_tol=1e-9):
            return
        if self.elapsed_s <= 0.0:
            self.entry = row
            self._lay([_Stage(0.0, 0.0, 0.0, 1.0, row)], row)
        elif self.elapsed_s < self._brake_s:
            self._change_speed(float(row[5]))

    def _change_speed(self, wish_mps: float) -> None:
        stages = [s for s in self._stages if s.begin_s <= self.elapsed_s]
        last = stages[-1]
        if last.sign > 0 and last.begin_s == 0.0 and wish_mps < last.profile[SPEED]:
            last.profile = self._cut_short(last.profile, wish_mps)
            self.entry = last.profile
        begin = max(self.elapsed_s, last.begin_s + float(last.profile[T_ACC]))
        at_m, speed, _ = self._along(last, begin)
        accel = self._accel_limit()
        brake = _profile(self.entry, wish_mps, accel, self.limits, np.inf)
        change = _profile(self.entry, abs(wish_mps - speed), accel, self.limits, np.inf)
        sign = 1.0 if wish_mps > speed else -1.0
        if abs(wish_mps - speed) > 1e-6:
            used = (0.5 * (speed + wish_mps)) * change[T_ACC] + 0.5 * wish_mps * brake[T_ACC]
            if at_m + used > self.length_m:
                return
            stages.append(_Stage(begin, at_m, speed, sign, change))
        self.entry = self.entry.copy()
        self.entry[5] = wish_mps
        self._lay(stages, brake)

    def _accel_limit(self) -> float:
        level = math.hypot(self.unit[0], self.unit[1])
        rise = abs(self.unit[2])
        accel = self.limits[3] / level if level > 0 else math.inf
        return min(accel, self.limits[4] / rise) if rise > 0 else float(accel)

    def _cut_short(self, row: Array, wish_mps: float) -> Array:
        """The speed-up in progress, its constant acceleration ended as early as still possible."""
        rise_s = 2.0 * float(row[T_J]) + float(row[T_2])
        least_s = max(0.0, self.elapsed_s - rise_s)
        if least_s >= row[T_4]:
            return row
        kept_s = max(least_s, wish_mps / float(row[ACCEL]) - rise_s)
        cut = row.copy()
        cut[T_4] = min(float(row[T_4]), kept_s)
        cut[SPEED] = float(row[ACCEL]) * (rise_s + cut[T_4])
        cut[T_ACC] = 2.0 * rise_s + cut[T_4]
        return cut
