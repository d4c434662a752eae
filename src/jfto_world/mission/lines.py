"""Which waypoints of a route lie so that one order takes all their photographs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from jfto_msgs_py.records.plan import Line, Waypoint
from jfto_msgs_py.types import Array
from jfto_world.mission.steps import same_aim

# A photograph may be this far from its waypoint, and look this far beside what is planned.
PLACE_M, LOOK_DEG = 0.5, 0.5
# The same of photographs by time, where speed is not quite constant.
TIMED_PLACE_M = 1.0
# The autopilot looks at distance and time 50 times a second, and so is late by up to that much
# every time; a line ends before that adds up to this.
LOOKS_EVERY_S, DRIFT_M = 0.02, 1.5
SPACING_MIN_M = 2.0
# Fewer waypoints are not worth the steps of a line: six by distance, four by time; and of three by
# time nothing shows whether speed is constant.
LEAST = {"distance": 4, "time": 4}
# A series by time begins at once only where the last photograph is at least an interval ago.
PAUSE_S = 0.1

# Arrivals (K,) of a route's waypoints, s, if it is flown with such lines.
Flown = Callable[[tuple[Line, ...]], Array]


def trigger_lines(
    waypoints: Sequence[Waypoint], trigger: str, speed_mps: float, flown: Flown
) -> tuple[Line, ...]:
    """Lines of a route whose photographs are triggered by "distance" or "time", in its order.

    On each, waypoints look the same way and stand on a straight line at one slope, equally far
    apart; by time they are also equally long apart, which needs a straight way to the first.
    """
    if trigger not in LEAST:
        return ()
    most = 2 + int(DRIFT_M / (speed_mps * LOOKS_EVERY_S))
    lines, k = [], 0
    while k < len(waypoints):
        last = _straight_until(waypoints, k, most)
        if last - k + 1 >= LEAST[trigger]:
            lines.append(Line(k, last))
            k = last
        k += 1
    found = tuple(lines)
    return _steady(found, waypoints, flown) if trigger == "time" else found


def beside_m(waypoints: Sequence[Waypoint], line: Line) -> float:
    """How far the worst waypoint of a line is from its equal share of it."""
    points = np.array([waypoint.position_m for waypoint in waypoints[line.first : line.last + 1]])
    shares = np.linspace(0.0, 1.0, len(points))[:, None]
    return float(
        np.linalg.norm(points - (points[0] + shares * (points[-1] - points[0])), axis=1).max()
    )


def _straight_until(waypoints: Sequence[Waypoint], first: int, most: int) -> int:
    """The last waypoint up to which all stand on one line from `first`."""
    begin, last = waypoints[first], first
    for k in range(first + 1, min(first + most, len(waypoints))):
        if not (begin.photo and waypoints[k].photo and same_aim(begin, waypoints[k], LOOK_DEG)):
            break
        line = Line(first, k)
        apart_m = math.dist(begin.position_m[:2], waypoints[k].position_m[:2]) / (k - first)
        if apart_m < SPACING_MIN_M or beside_m(waypoints, line) > PLACE_M:
            break
        last = k
    return last


def _interval_s(arrival_s: Array, line: Line) -> float:
    """Time between the photographs of a line, of which the last is taken where it is reached."""
    count = line.last - 1 - line.first
    return float(arrival_s[line.last - 1] - arrival_s[line.first]) / count


def _steady(
    lines: tuple[Line, ...], waypoints: Sequence[Waypoint], flown: Flown
) -> tuple[Line, ...]:
    """The lines on which photographs at equal times are near their waypoints.

    Where a line is none, its waypoints are flown to one by one, which changes the others' times.
    """
    points = np.array([waypoint.position_m for waypoint in waypoints])
    while lines:
        arrival_s = flown(lines)
        kept = tuple(line for line in lines if _is_steady(line, arrival_s, points))
        if kept == lines:
            break
        lines = kept
    return lines


def _is_steady(line: Line, arrival_s: Array, points: Array) -> bool:
    every_s = _interval_s(arrival_s, line)
    if line.first and arrival_s[line.first] - arrival_s[line.first - 1] < every_s + PAUSE_S:
        return False
    inside = slice(line.first, line.last)
    even_s = arrival_s[line.first] + every_s * np.arange(line.last - line.first)
    speed_mps = math.dist(points[line.first], points[line.last - 1]) / (even_s[-1] - even_s[0])
    return bool((np.abs(arrival_s[inside] - even_s) * speed_mps).max() <= TIMED_PLACE_M)
