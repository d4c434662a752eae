"""Whether a route fits into the mission that an autopilot can hold, and its lines are lines."""

from __future__ import annotations

import math
from collections.abc import Sequence

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.certificate import Violation
from jfto_msgs_py.records.plan import Plan, Waypoint
from jfto_world.mission.lines import LOOK_DEG, PLACE_M, beside_m
from jfto_world.mission.steps import AIM_DEG, STEEPEST_LOOK_DEG, mission_items, same_aim

# Waypoint, shutter and where to look, if that changes every time.
PHOTO_ITEMS = 3
# Home, take-off and three speeds; hold, landing, and legs of a way home, which are few.
_KEPT_FREE = 20
# Routes differ in length.
_UNEVEN = 1.1
_CURES = "More UAVs (fleet.count), fewer waypoints"
_BY_DISTANCE = "coverage.trigger distance, where photographs lie on straight lines"


def most_photos(items_max: int, items_each: float = PHOTO_ITEMS) -> int:
    """How many photos one UAV's mission surely holds that take so many items each."""
    return max(int((items_max - _KEPT_FREE) / items_each), 1)


def check_mission_size(plan: Plan) -> list[Violation]:
    """One violation for each UAV whose mission no autopilot would take whole."""
    found = []
    for index, uav in enumerate(plan.uavs):
        items = mission_items(plan, index)
        if items > plan.mission_items:
            photos = len(plan.routes[index].waypoint_ids)
            also = "" if plan.trigger == "distance" else f", or {_BY_DISTANCE}"
            message = (
                f"{uav.id}: its {photos} photos make a mission of {items} items, its autopilot "
                f"holds {plan.mission_items} (fleet.mission_items). {_CURES}{also}"
            )
            found.append(Violation("items", uav.id, None, None, items, plan.mission_items, message))
    return found


def check_lines(plan: Plan) -> list[Violation]:
    """One violation for each line of a route whose photographs would not be those planned."""
    found = []
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    for uav, route in zip(plan.uavs, plan.routes, strict=True):
        waypoints = [by_id[number] for number in route.waypoint_ids if number in by_id]
        for line in route.lines:
            on_it = waypoints[line.first : line.last + 1]
            off_m = beside_m(waypoints, line)
            alike = all(each.photo and same_aim(on_it[0], each, LOOK_DEG) for each in on_it)
            if off_m <= PLACE_M + 1e-6 and alike:
                continue
            reason = f"is {off_m:.2f} m beside it" if alike else "does not look the same way"
            message = (
                f"{uav.id}: of the line from waypoint {on_it[0].id} to {on_it[-1].id}, which is "
                f"photographed by {plan.trigger}, one {reason}"
            )
            found.append(Violation("line", uav.id, None, None, off_m, PLACE_M, message))
    return found


def require_missions_to_hold(
    waypoints: Sequence[Waypoint], uavs: int, items_max: int, trigger: str = "each"
) -> None:
    """Raise InfeasibleError where no division of the waypoints fits, before any search."""
    needed = least_items(waypoints, trigger)
    held = uavs * (items_max - _KEPT_FREE)
    if needed <= held:
        return
    photos = sum(waypoint.photo for waypoint in waypoints)
    most = most_photos(items_max, needed / photos)
    raise InfeasibleError(
        f"{photos} photographs do not fit into the missions of {uavs} UAV{'s' * (uavs > 1)}: they "
        f"take {needed} items or more, and an autopilot holds {items_max} (fleet.mission_items), "
        f"that is about {most} photos.",
        cures=(
            f"fleet.count of {-(-photos // most)} or more",
            f"{uavs * most} waypoints or fewer (coverage.gsd_cm, overlap_h, overlap_v)",
            *((_BY_DISTANCE,) if trigger == "each" else ()),
        ),
    )


def least_items(waypoints: Sequence[Waypoint], trigger: str = "each") -> int:
    """Items that the photographs take at least, whatever the routes.

    Waypoint and shutter each, unless lines spare them, and one for every way to look.
    """
    photos = [waypoint for waypoint in waypoints if waypoint.photo]
    return _ways_to_look(photos) + (2 * len(photos) if trigger == "each" else 0)


def photo_capacity(waypoints: Sequence[Waypoint], uavs: int, items_max: int) -> int:
    """How many photographs a route may have: what surely fits, else a little over an even share.

    The certificate counts what that comes to.
    """
    photos = [waypoint for waypoint in waypoints if waypoint.photo]
    steep = any(waypoint.pitch_deg < STEEPEST_LOOK_DEG for waypoint in photos)
    sure = most_photos(items_max, PHOTO_ITEMS + steep)
    even = -(-len(photos) // uavs)
    return sure if even <= sure else math.ceil(_UNEVEN * even)


def _ways_to_look(photos: Sequence[Waypoint]) -> int:
    """Waypoints no two of which can be looked from by one order."""
    apart_deg = 2 * AIM_DEG
    taken: dict[tuple[int, int], list[Waypoint]] = {}
    count = 0
    for photo in photos:
        row = math.floor(photo.pitch_deg / apart_deg)
        column = math.floor(photo.yaw_deg % 360.0 / apart_deg)
        columns = round(360.0 / apart_deg)
        near = (
            other
            for r in (row - 1, row, row + 1)
            for c in (column - 1, column, column + 1)
            for other in taken.get((r, c % columns), ())
        )
        if not any(same_aim(photo, other, apart_deg) for other in near):
            taken.setdefault((row, column), []).append(photo)
            count += 1
    return count
