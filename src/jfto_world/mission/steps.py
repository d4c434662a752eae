"""A route as the fewest steps that fly and photograph it: what is built, and what is counted.

Photo k's camera and heading are set on the leg before it: waypoint k - 1, shutter, camera for k,
heading for k, waypoint k, shutter … ArduCopter's order to turn blocks what stands behind it and
drops it when the next waypoint comes first, so it stands last.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from jfto_msgs_py.records.plan import Line, Plan, Waypoint
from jfto_world.mission.encoding import Encoding

# Two directions are one within this.
AIM_DEG = 0.1
# A turn that may not have ended when its waypoint comes is ordered again: 180° take 3 s.
TURN_S = 4.0
# Steeper than this a far place has no bearing that a few metres leave alone.
STEEPEST_LOOK_DEG = -85.0


class Kind(Enum):
    """What a step does. `value` and `other` of the step are given in brackets."""

    LOOK = "look along a heading (deg) and a pitch (deg), at a far place"
    TILT = "tilt the camera to a pitch (deg)"
    TURN = "turn the nose to a heading (deg)"
    GO = "fly to the waypoint"
    SHOOT = "take a photograph"
    EVERY = "take one here, and one every (m) flown"
    SERIES = "take one here, and one every (s), so many in all"
    WITHIN = "wait until (m) before the next waypoint"
    NO_MORE = "take no more along the way"
    GATE = "wait for the waypoint's time"


@dataclass(frozen=True)
class Step:
    """One item of a mission; `waypoint` is an index along the route."""

    kind: Kind
    waypoint: int
    value: float = 0.0
    other: float = 0.0


@dataclass(frozen=True)
class RouteSteps:
    """Steps of a route; `keeps_heading` says that a heading must outlast a waypoint."""

    steps: tuple[Step, ...]
    keeps_heading: bool


def turn_deg(a: float, b: float) -> float:
    """Angle between two headings."""
    return abs((a - b + 180.0) % 360.0 - 180.0)


def same_aim(a: Waypoint, b: Waypoint, within_deg: float = AIM_DEG) -> bool:
    """Whether two waypoints look the same way."""
    return (
        abs(a.pitch_deg - b.pitch_deg) <= within_deg
        and turn_deg(a.yaw_deg, b.yaw_deg) <= within_deg
    )


def route_steps(
    waypoints: Sequence[Waypoint],
    arrival_s: Sequence[float],
    lines: Sequence[Line],
    encoding: Encoding,
    trigger: str = "each",
) -> RouteSteps:
    """Steps of a route's waypoints in order, reached at `arrival_s`; `lines` are triggered ones.

    Waypoints inside a line have no step of their own.
    """
    writer = _Writer(waypoints, arrival_s, encoding)
    first_of = {line.first: line for line in lines}
    ends = {line.last: line for line in lines}
    inside = {k for line in lines for k in range(line.first + 1, line.last)}
    last = len(waypoints) - 1
    for k, waypoint in enumerate(waypoints):
        if k in inside:
            continue
        if waypoint.photo and k not in ends:
            writer.aim(k, along=k in first_of)
        writer.add(Kind.GO, k)
        if not waypoint.photo or encoding.shutter == "none":
            pass
        elif k in first_of:
            writer.row(first_of[k], trigger)
        else:
            writer.add(Kind.SHOOT, k)
        if k in encoding.gates and k < last:
            writer.add(Kind.GATE, k)
    return RouteSteps(tuple(writer.steps), writer.keeps_heading)


class _Writer:
    """Writes steps and remembers which way camera and nose were set."""

    def __init__(
        self, waypoints: Sequence[Waypoint], arrival_s: Sequence[float], encoding: Encoding
    ) -> None:
        self.steps: list[Step] = []
        self.keeps_heading = False
        self._waypoints, self._encoding = waypoints, encoding
        self._legs_s = np.diff(np.array([0.0, *arrival_s]))
        self._pitch_deg: float | None = None
        self._yaw_deg: float | None = None
        self._turned = True

    def add(self, kind: Kind, k: int, value: float = 0.0, other: float = 0.0) -> None:
        self.steps.append(Step(kind, k, value, other))

    def aim(self, k: int, *, along: bool) -> None:
        """Set what must be for waypoint k; `along` where it must hold for more than this one."""
        waypoint, encoding = self._waypoints[k], self._encoding
        tilt = encoding.mount != "none" and not _near(self._pitch_deg, waypoint.pitch_deg)
        turn = encoding.turn and not (
            self._turned
            and self._yaw_deg is not None
            and turn_deg(self._yaw_deg, waypoint.yaw_deg) <= AIM_DEG
        )
        if not tilt and not turn:
            self.keeps_heading |= encoding.turn
            return
        if encoding.mount == "look_at" and encoding.turn and not along and self._alone(k):
            self.add(Kind.LOOK, k, waypoint.yaw_deg % 360.0, waypoint.pitch_deg)
            self._pitch_deg = self._yaw_deg = None
            return
        if tilt:
            self.add(Kind.TILT, k, waypoint.pitch_deg)
            self._pitch_deg = waypoint.pitch_deg
            # This order also turns the nose of a vehicle whose mount does not pan.
            turn = encoding.turn and (turn or encoding.mount in ("look_at", "mount_control"))
        if turn:
            self.add(Kind.TURN, k, waypoint.yaw_deg % 360.0)
            self._yaw_deg = waypoint.yaw_deg
            self._turned = bool(self._legs_s[k] >= TURN_S)
        self.keeps_heading |= along and encoding.turn

    def _alone(self, k: int) -> bool:
        """Whether no later waypoint is served by looking the same way as k."""
        waypoint = self._waypoints[k]
        if waypoint.pitch_deg < STEEPEST_LOOK_DEG:
            return False
        after = next((each for each in self._waypoints[k + 1 :] if each.photo), None)
        return after is None or not same_aim(waypoint, after)

    def row(self, line: Line, trigger: str) -> None:
        """Photographs from the first waypoint of a line on, all but the last.

        That one is taken where it is reached, as all others are.
        """
        count = line.last - line.first
        if trigger == "time":
            legs_s = self._legs_s[line.first + 1 : line.last]
            self.add(Kind.SERIES, line.first, float(legs_s.mean()), count)
            return
        first, last = (self._waypoints[k].position_m for k in (line.first, line.last))
        spacing_m = math.dist(first[:2], last[:2]) / count
        self.add(Kind.EVERY, line.first, spacing_m)
        self.add(Kind.WITHIN, line.last, 0.5 * spacing_m)
        self.add(Kind.NO_MORE, line.last)


def _near(known: float | None, wanted: float) -> bool:
    return known is not None and abs(known - wanted) <= AIM_DEG


# Level, climb, descent.
SPEEDS = (1.0, 2.0, 3.0)
# Home and take-off; hold and landing at the end of a planned way home.
_BEGIN, _HOLD_AND_LAND = 2, 2


def mission_items(plan: Plan, uav: int, encoding: Encoding | None = None) -> int:
    """Items of the mission of the UAV with this index, home included.

    Exact for a plan with ways home; of a plain return, the climb that it may need is counted.
    """
    encoding = encoding or Encoding()
    route = plan.routes[uav]
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    waypoints = [by_id[number] for number in route.waypoint_ids if number in by_id]
    steps = route_steps(waypoints, route.arrival_s, route.lines, encoding, plan.trigger).steps
    begin = _BEGIN + (len(SPEEDS) if encoding.speeds else 0)
    return begin + len(steps) + _ending_items(plan, uav, encoding)


def _ending_items(plan: Plan, uav: int, encoding: Encoding) -> int:
    if plan.homes and encoding.relay:
        streamed = len(SPEEDS) if plan.trajectories else 0
        return _HOLD_AND_LAND + len(plan.homes[uav].line_m) - 1 + streamed
    waits = encoding.relay and plan.slots.horizon_s - plan.routes[uav].end_s >= 1
    climb_and_return = 2
    return climb_and_return + int(waits)
