"""What a plan's Bezier trajectories do, computed anew from their control points.

Shares no code with the smoothing that made them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from jfto_msgs_py.errors import PlanError
from jfto_msgs_py.records.certificate import Violation
from jfto_msgs_py.records.plan import Plan, Uav
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import GRAVITY_MPS2

SAMPLES = 40
# Control points are rounded to micrometres in a plan file, derivatives are coarser for it.
TOLERANCE_M = 1e-3
JUMPS = ("m", TOLERANCE_M), ("m/s", 1e-2), ("m/s²", 0.1)
LIMIT_TOLERANCE = 1e-3
_KEYS = ("kind", "delay_s", "duration_s", "waypoint_s", "control_m")


@dataclass(frozen=True)
class Curve:
    """Control points (S, 6, 3), begin of each segment and end of the last (S + 1,), passages."""

    control_m: Array
    knots_s: Array
    waypoint_s: Array

    def at(self, times_s: Array) -> Array:
        """Positions (T, 3); at rest before the first segment and after the last."""
        last = len(self.control_m) - 1
        which = np.clip(np.searchsorted(self.knots_s, times_s, side="right") - 1, 0, last)
        span = np.diff(self.knots_s)[which]
        share = np.clip((times_s - self.knots_s[which]) / span, 0.0, 1.0)
        return np.asarray(np.einsum("ti,tik->tk", _basis(share, 5), self.control_m[which]))

    def derivatives(self, share: Array) -> list[Array]:
        """Position to jerk (S, T, 3) at shares (T,) of each segment."""
        points, span, found = self.control_m, np.diff(self.knots_s)[:, None, None], []
        for degree in (5, 4, 3, 2):
            found.append(np.asarray(np.einsum("ti,sik->stk", _basis(share, degree), points)))
            points = degree * np.diff(points, axis=1) / span
        return found


def curves_of(plan: Plan) -> list[Curve]:
    """Trajectories of a plan, one per UAV; raises PlanError where a record is not sound."""
    if len(plan.trajectories) != len(plan.uavs):
        raise PlanError(
            f"plan: {len(plan.trajectories)} trajectories for {len(plan.uavs)} UAVs, must be one "
            "each under the time model bezier. Write the plan anew with jfto plan."
        )
    return [
        _curve(uav, record, len(route.waypoint_ids) + 1)
        for uav, record, route in zip(plan.uavs, plan.trajectories, plan.routes, strict=True)
    ]


def _curve(uav: Uav, record: Mapping[str, Any], points: int) -> Curve:
    problem = ""
    if sorted(record) != sorted(_KEYS) or record["kind"] != "bezier5":
        problem = f"is not of kind bezier5 with the keys {', '.join(_KEYS)}"
    else:
        try:
            control = np.array(record["control_m"], dtype=np.float64)
            duration = np.array(record["duration_s"], dtype=np.float64)
            passed = np.array(record["waypoint_s"], dtype=np.float64)
            delay = float(record["delay_s"])
        except (TypeError, ValueError):
            problem = "holds something that is not a number"
        else:
            problem = _fault(control, duration, passed, delay, points)
    if problem:
        raise PlanError(
            f"plan: the trajectory of {uav.id} {problem}. Write the plan anew with jfto plan."
        )
    return Curve(control, delay + np.concatenate([[0.0], np.cumsum(duration)]), passed)


def _fault(control: Array, duration: Array, passed: Array, delay: float, points: int) -> str:
    if duration.ndim != 1 or not len(duration) or control.shape != (len(duration), 6, 3):
        return f"has {duration.shape} durations for control points {control.shape}"
    if passed.shape != (points,):
        return f"has times for {len(passed)} points, its route has {points}"
    if not all(np.isfinite(value).all() for value in (control, duration, passed, delay)):
        return "holds a number that is not finite"
    if not (duration > 0).all() or delay < 0:
        return "runs backwards in time"
    return ""


def check_curves(plan: Plan, curves: list[Curve], lines: list[Array]) -> list[Violation]:
    """Waypoints that a curve misses, jumps, and limits that it exceeds.

    `lines` are pad and waypoints (M, 3) of each route.
    """
    found = []
    for uav, curve, line in zip(plan.uavs, curves, lines, strict=True):
        if len(line) == len(curve.waypoint_s):
            found += _check_passages(uav, curve, line)
        found += _check_joints(uav, curve)
        found += _check_limits(uav, curve, plan.time_parameters)
    return found


def _check_passages(uav: Uav, curve: Curve, line: Array) -> list[Violation]:
    found = []
    ends = np.stack([curve.control_m[0, 0], curve.control_m[-1, -1]])
    apart = np.linalg.norm(curve.at(curve.waypoint_s) - line, axis=1)
    apart[[0, -1]] = np.maximum(apart[[0, -1]], np.linalg.norm(ends - line[[0, -1]], axis=1))
    for k in np.flatnonzero(apart > TOLERANCE_M):
        where, time = ("its pad", "waypoint " + str(k))[int(k > 0)], float(curve.waypoint_s[k])
        gap = float(apart[k])
        message = f"{uav.id} is {gap:.3f} m from {where} of its route at {time:.2f} s"
        found.append(Violation("route", uav.id, None, time, gap, TOLERANCE_M, message))
    return found


def _check_joints(uav: Uav, curve: Curve) -> list[Violation]:
    first, last = (curve.derivatives(np.array([share])) for share in (0.0, 1.0))
    found = []
    for order, (unit, limit) in enumerate(JUMPS):
        rest = np.zeros((1, 1, 3))
        before, after = last[order], first[order]
        if order:
            before, after = np.concatenate([rest, before]), np.concatenate([after, rest])
            times = curve.knots_s
        else:
            before, after, times = before[:-1], after[1:], curve.knots_s[1:-1]
        jump = np.linalg.norm(after - before, axis=2).max(axis=1, initial=0.0)
        for k in np.flatnonzero(jump > limit)[:1]:
            time = float(times[k])
            message = f"{uav.id}'s trajectory jumps by {jump[k]:.3g} {unit} at {time:.2f} s"
            found.append(Violation("route", uav.id, None, time, float(jump[k]), limit, message))
    return found


def _check_limits(uav: Uav, curve: Curve, limits: Mapping[str, float]) -> list[Violation]:
    _, speed, accel, jerk = curve.derivatives(np.linspace(0.0, 1.0, SAMPLES + 1))
    thrust = accel + limits.get("drag_1ps", 0.0) * speed
    lift = np.maximum(GRAVITY_MPS2 + thrust[..., 2], 1e-9)
    tilt = np.degrees(np.arctan2(np.hypot(thrust[..., 0], thrust[..., 1]), lift))
    asked = (
        ("horizontal speed", "m/s", np.hypot(speed[..., 0], speed[..., 1]), uav.speed_mps),
        ("climb speed", "m/s", speed[..., 2], uav.climb_mps),
        ("descent speed", "m/s", -speed[..., 2], uav.descent_mps),
        (
            "horizontal acceleration",
            "m/s²",
            np.hypot(accel[..., 0], accel[..., 1]),
            limits.get("accel_mps2", math.inf),
        ),
        (
            "vertical acceleration",
            "m/s²",
            np.abs(accel[..., 2]),
            limits.get("accel_z_mps2", math.inf),
        ),
        ("jerk", "m/s³", np.linalg.norm(jerk, axis=-1), limits.get("jerk_mps3", math.inf)),
        ("tilt", "°", tilt, limits.get("tilt_deg", math.inf)),
    )
    found = []
    for name, unit, values, limit in asked:
        worst = float(values.max())
        if worst > limit * (1 + LIMIT_TOLERANCE):
            segment = int(np.argmax(values.max(axis=1)))
            time = float(curve.knots_s[segment])
            message = (
                f"{uav.id}'s trajectory asks for {worst:.3f} {unit} of {name} after {time:.1f} s, "
                f"{limit:g} {unit} are allowed"
            )
            found.append(Violation("route", uav.id, None, time, worst, limit, message))
    return found


def _basis(share: Array, degree: int) -> Array:
    """Bernstein polynomials (T, degree + 1) at shares (T,)."""
    power = np.arange(degree + 1)
    factor = np.array([math.comb(degree, k) for k in power], dtype=np.float64)
    s = share[:, None]
    return np.asarray(factor * s**power * (1.0 - s) ** (degree - power))
