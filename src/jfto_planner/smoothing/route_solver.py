"""The outer search over one route: cruise speeds, knots and durations, joint by joint."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.types import Array, Flags
from jfto_planner.smoothing.kernel.joint import Route, fix_joint, leg_limit, new_joint, solve_joint
from jfto_planner.smoothing.kernel.segment import ACCEL, JERK

_COARSE, _MIDDLE = 14, 60  # samples per segment: search, repair
_SLOWER, _FASTER = 0.8, 1.25


class RouteSolver:
    """Joints of a route of M distinct consecutive points, improved in place.

    `pars` (M, 5), `states` (M, 3, 3, 3), `durations` (M, 2) and `speeds` (M - 1,) as in `Route`.
    Where no pass fits the corridor, `stop` is set.
    """

    def __init__(self, points: Array, stop: Flags, cap: Array, lim: Array, corridor: float) -> None:
        count = len(points)
        self.points, self.stop, self.cap = points, stop.copy(), cap
        self.lim = lim
        step = np.diff(points, axis=0)
        self.length = np.linalg.norm(step, axis=1)
        unit = step / self.length[:, None]
        self.top = np.array([leg_limit(u[0], u[1], u[2], lim) for u in unit])
        self.speeds = np.array(
            [self._speed_for(size, top) for size, top in zip(self.length, self.top, strict=True)]
        )
        self.pars, self.frames = np.zeros((count, 5)), np.zeros((count, 5, 3))
        self.states, self.durations = np.zeros((count, 3, 3, 3)), np.zeros((count, 2))
        for k in range(count):
            self._set_frame(k, unit)
        self._route = Route(
            points, self.stop, cap, lim, corridor, self.speeds, self.pars, self.frames,
            self.states, self.durations, new_joint(),
        )  # fmt: skip

    def _ramp_s(self, speed: float) -> float:
        """Duration of a speed-up from rest: velocity 3 s² - 2 s³ of the final speed."""
        return max(1.5 * speed / self.lim[ACCEL], float(np.sqrt(6.0 * speed / self.lim[JERK])))

    def _speed_for(self, length: float, top: float) -> float:
        """First guess of a leg's cruise speed: what a moderate ramp reaches in half of the leg."""
        speed = top
        while 0.35 * speed * self._ramp_s(speed) > 0.48 * length:
            speed *= 0.9
        return speed

    def _set_frame(self, k: int, unit: Array) -> None:
        """Directions of a joint and its first knots: room to stop, at most half of a leg."""
        frame = self.frames[k]
        frame[0] = self.points[k]
        if k > 0:
            frame[1] = unit[k - 1]
        if k < len(self.top):
            frame[2] = unit[k]
        if 0 < k < len(self.top):
            turn = frame[2] - frame[1]
            for row, along in ((3, frame[1]), (4, frame[2])):
                aside = (turn @ along) * along - turn
                size = np.linalg.norm(aside)
                frame[row] = aside / size if size > 1e-9 else 0.0
        for side, leg in ((0, k - 1), (1, k)):
            if 0 <= leg < len(self.top):
                speed = self.speeds[leg]
                reach = min(0.48 * self.length[leg], 0.55 * speed * self._ramp_s(speed))
                self.pars[k, side] = np.log(reach)
                sign = 1.0 if side else -1.0
                self.states[k, 2 * side, 0] = self.points[k] + sign * reach * unit[leg]

    def _solve(self, k: int, full: bool, samples: int = _COARSE) -> float:
        return solve_joint(self._route, k, full, samples)

    def run(self, sweeps: int) -> None:
        """Search all joints, then improve speeds and joints `sweeps` times, then settle."""
        count = len(self.points)
        for k in range(count):
            self._first(k)
        for _ in range(sweeps):
            for leg in range(count - 1):
                self._try_speeds(leg)
            for k in range(count):
                self._solve(k, False)
        self._settle()

    def _first(self, k: int) -> None:
        """First solution of a joint: slower legs beside it, or a stop there, until there is one."""
        for attempt in range(60):
            if self._solve(k, True) < np.inf:
                return
            if attempt == 20:
                self._stop_at(k)
            self._slow(k)
        raise _no_curve(k)

    def _stop_at(self, k: int) -> None:
        self.stop[k] = True
        self.pars[k, 2:] = 0.0

    def _slow(self, k: int) -> list[int]:
        """Slow the legs beside a joint; returns the joints that this touches."""
        legs = [leg for leg in (k - 1, k) if 0 <= leg < len(self.speeds)]
        self.speeds[legs] *= _SLOWER
        return sorted({joint for leg in legs for joint in (leg, leg + 1)})

    def _line_s(self, leg: int) -> float:
        step = self.states[leg + 1, 0, 0] - self.states[leg, 2, 0]
        size = float(np.linalg.norm(step))
        return size / min(self.speeds[leg], leg_limit(step[0], step[1], step[2], self.lim))

    def _around_s(self, leg: int) -> float:
        """Time of the two joints of a leg and the lines around them."""
        lines = sum(self._line_s(k) for k in (leg - 1, leg, leg + 1) if 0 <= k < len(self.speeds))
        return lines + float(np.sum(self.durations[leg : leg + 2]))

    def _try_speeds(self, leg: int) -> None:
        """Keep a faster or slower cruise on a leg where that saves time."""
        reach = np.exp(self.pars[leg, 1]) + np.exp(self.pars[leg + 1, 0])
        if self.speeds[leg] >= self.top[leg] and reach < 0.8 * self.length[leg]:
            return
        for factor in (_FASTER, _SLOWER):
            for _ in range(4):
                before = self._around_s(leg)
                kept = [
                    array[leg : leg + 2].copy()
                    for array in (self.pars, self.states, self.durations)
                ]
                speed = self.speeds[leg]
                self.speeds[leg] = min(speed * factor, self.top[leg])
                better = (
                    self.speeds[leg] != speed
                    and self._solve(leg, False) < np.inf
                    and self._solve(leg + 1, False) < np.inf
                    and self._around_s(leg) < before - 1e-3
                )
                if not better:
                    self.speeds[leg] = speed
                    for array, old in zip(
                        (self.pars, self.states, self.durations), kept, strict=True
                    ):
                        array[leg : leg + 2] = old
                    break

    def _settle(self) -> None:
        """Final durations with all knots fixed, sampled densely; repairs joints that do not fit."""
        count = len(self.points)
        tries = np.zeros(count, dtype=np.intp)
        waiting = list(range(count))
        while waiting:
            failed = [k for k in waiting if not fix_joint(self._route, k) < np.inf]
            again: set[int] = set()
            for k in failed:
                tries[k] += 1
                if tries[k] > 1:
                    again |= set(self._slow(k))
                if tries[k] == 12:
                    self._stop_at(k)
                self._solve(k, True, _MIDDLE)
                again |= {k - 1, k, k + 1}
            if failed and tries.max() > 40:
                raise _no_curve(int(np.argmax(tries)))
            waiting = sorted(again & set(range(count)))


def _no_curve(k: int) -> InfeasibleError:
    return InfeasibleError(
        f"No trajectory through point {k} of the route keeps the limits.",
        cures=("raise the limits of acceleration or jerk", "widen the corridor"),
    )
