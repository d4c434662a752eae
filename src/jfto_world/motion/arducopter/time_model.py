"""Times and positions along a mission as ArduCopter flies it, behind the common interface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import lru_cache

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array
from jfto_world.motion.arducopter.closed_loop import Flight, fly_route
from jfto_world.motion.arducopter.leg_profile import (
    COLUMNS,
    fill_chain_times,
    fill_leg_times,
    planner_limits,
)
from jfto_world.motion.arducopter.takeoff import takeoff_height_m, takeoff_s
from jfto_world.motion.arducopter.target import TargetTrack, plan_target
from jfto_world.motion.arducopter.wpnav import Airframe, WpNav
from jfto_world.motion.time_model import MotionLimits

# mean time that the vehicle's lag adds to a leg of 30 to 300 m, in closed loop at 5 to 10 m/s
_LAG_FLY_S, _LAG_STOP_S = 0.2, 0.45
_OWN = ("hold_s", "takeoff_m")
_WPNAV = tuple(entry.name for entry in fields(WpNav) if "speed" not in entry.name)
_AIRFRAME = tuple(entry.name for entry in fields(Airframe))


@dataclass(frozen=True)
class ArduCopter:
    """`TimeModel` of a waypoint mission: straight legs, rounded or stopped corners.

    The three speeds come from each vehicle's limits, the rest from `wpnav`. With `closed_loop` the
    vehicle's lag counts too (use it for everything final); without, times are the planner's own
    closed form: ten times faster, about 0.2 s per leg early. `hold_s` > 0 stops at every waypoint;
    0 flies through. `takeoff_m` > 0 climbs that far straight up from the first point before the
    first leg. `wind_mps` (east, north) acts in closed loop only.
    """

    wpnav: WpNav = field(default_factory=WpNav)
    airframe: Airframe = field(default_factory=Airframe)
    hold_s: float = 0.0
    takeoff_m: float = 0.0
    closed_loop: bool = True
    wind_mps: tuple[float, float] = (0.0, 0.0)
    step_s: float = 0.02

    name = "arducopter"

    def __post_init__(self) -> None:
        for entry in ("hold_s", "takeoff_m"):
            if not getattr(self, entry) >= 0:
                raise InputError(f"{entry} is {getattr(self, entry)}, must not be negative.")
        if not 0 < self.step_s <= 0.05:
            raise InputError(f"step_s is {self.step_s}, must be above 0 and at most 0.05.")

    @classmethod
    def of_parameters(cls, parameters: Mapping[str, float]) -> ArduCopter:
        """The model in calm air that has these `parameters()`; raises InputError."""
        parts: dict[str, dict[str, float]] = {"wpnav": {}, "airframe": {}, "own": {}}
        places = {
            **dict.fromkeys(_WPNAV, "wpnav"),
            **dict.fromkeys(_AIRFRAME, "airframe"),
            **dict.fromkeys(_OWN, "own"),
        }
        for name, value in parameters.items():
            if name not in places:
                raise InputError(
                    f"time_parameters has an unknown key {name}. Known are {', '.join(places)}."
                )
            parts[places[name]][name] = float(value)
        return cls(
            WpNav(**parts["wpnav"]),
            Airframe(**parts["airframe"]),
            hold_s=parts["own"].get("hold_s", 0.0),
            takeoff_m=parts["own"].get("takeoff_m", 0.0),
        )

    def parameters(self) -> dict[str, float]:
        """Everything that decides times in calm air, apart from the three speeds."""
        own: dict[str, float] = {name: getattr(self, name) for name in _OWN}
        own |= {name: getattr(self.wpnav, name) for name in _WPNAV}
        return own | {name: getattr(self.airframe, name) for name in _AIRFRAME}

    def leg_matrix(self, points_m: Array, limits: MotionLimits) -> Array:
        """Estimated time of the leg between each ordered pair of points, shape (M, M).

        Fly-through: the corner overlap at both ends is taken as that of a turn of 105° between
        equal legs; holds: rest to rest, hold included. With the mean lag of the vehicle where
        `closed_loop`. The diagonal is 0. The makespan of a route is the sum of its entries plus
        `overhead_s`, within 3 % on average over routes.
        """
        points = np.ascontiguousarray(points_m, dtype=np.float64)
        out = np.zeros((len(points), len(points)))
        limits_row = planner_limits(self.wpnav.within(limits))
        fill_leg_times(points, limits_row, self.hold_s > 0, np.zeros((2, COLUMNS)), out)
        out[~np.eye(len(points), dtype=bool)] += self._extra_s
        return out

    def chain_times(self, points_m: Array, limits: MotionLimits) -> Array:
        """Estimated time of each leg from one point to the next, shape (M - 1,)."""
        points = np.ascontiguousarray(points_m, dtype=np.float64)
        out = np.zeros(max(len(points) - 1, 0))
        limits_row = planner_limits(self.wpnav.within(limits))
        fill_chain_times(points, limits_row, self.hold_s > 0, np.zeros((2, COLUMNS)), out)
        return out + self._extra_s

    @property
    def _extra_s(self) -> float:
        """What a leg takes beyond its profile: the hold, and how far the vehicle lags behind."""
        if not self.closed_loop:
            return self.hold_s
        return self.hold_s + (_LAG_STOP_S if self.hold_s > 0 else _LAG_FLY_S)

    def overhead_s(self, limits: MotionLimits) -> float:
        """Time of a route beyond the sum of its `leg_matrix` entries, s.

        Take-off, and where the corners are flown through, the start and the end at rest.
        """
        extra = self._takeoff_s(limits)
        if self.hold_s == 0:
            corner = np.array([[0.0, 0, 0], [1e3, 0, 0], [1e3, 1e3, 0]])
            overlaps = plan_target(corner, self.wpnav.within(limits)).half_overlap_s
            extra += 2.0 * float(overlaps[1])
        return extra

    def arrivals(self, route_m: Array, limits: MotionLimits) -> Array:
        """Time at which each point is reached (hold included), shape (M,), the first being 0."""
        route = np.asarray(route_m, dtype=np.float64)
        reached = self._motion(route, limits).reached_s.copy()
        reached[1:] += self._takeoff_s(limits)
        return reached

    def positions(self, route_m: Array, limits: MotionLimits, times_s: Array) -> Array:
        """Positions at the given times, shape (T, 3); stays at the last point."""
        route = np.asarray(route_m, dtype=np.float64)
        times = np.atleast_1d(np.asarray(times_s, dtype=np.float64))
        climb_s = self._takeoff_s(limits)
        where = self._motion(route, limits).positions(times - climb_s)
        rising = times < climb_s
        height = takeoff_height_m(
            self.takeoff_m, limits.climb_mps, self.wpnav.accel_z_mps2, times[rising]
        )
        where[rising] = route[0]
        where[rising, 2] += height
        return where

    def _takeoff_s(self, limits: MotionLimits) -> float:
        return takeoff_s(self.takeoff_m, limits.climb_mps, self.wpnav.accel_z_mps2)

    def _motion(self, route: Array, limits: MotionLimits) -> Flight | TargetTrack:
        start = route.copy()
        start[0, 2] += self.takeoff_m
        return _cached_motion(self, limits, start.tobytes(), len(start))


@lru_cache(maxsize=64)
def _cached_motion(
    model: ArduCopter, limits: MotionLimits, route: bytes, count: int
) -> Flight | TargetTrack:
    points = np.frombuffer(route, dtype=np.float64).reshape(count, 3)
    wpnav = model.wpnav.within(limits)
    hold = np.full(count, model.hold_s)
    if not model.closed_loop:
        return plan_target(points, wpnav, None, hold)
    return fly_route(
        points,
        wpnav,
        model.airframe,
        hold_s=hold,
        wind_mps=model.wind_mps,
        step_s=model.step_s,
    )
