"""Whether a UAV's route fits into the mission that an autopilot can hold.

Missions are made elsewhere; this counts their items from the plan alone.
"""

from __future__ import annotations

from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.records.certificate import Violation
from jfto_msgs_py.records.plan import Plan

# Items that the boards in use hold at least, home included.
ITEMS_MAX = 650
# Camera, heading, waypoint and shutter; home, take-off and three speeds; the plain way home.
PHOTO_ITEMS, BEGIN_ITEMS, HOME_ITEMS = 4, 5, 3
# Of a planned way home: hold and landing, and speeds where the route was streamed.
HOLD_ITEMS, STREAMED_ITEMS = 2, 3
# Legs of a planned way home are few; so many are kept free for them before there is a plan.
_SPARE_ITEMS = 10


def most_photos() -> int:
    """How many photos one UAV's mission holds."""
    return (ITEMS_MAX - BEGIN_ITEMS - HOME_ITEMS - _SPARE_ITEMS) // PHOTO_ITEMS


def mission_items(plan: Plan, uav: int) -> int:
    """Items of the mission of the UAV with this index."""
    home = HOME_ITEMS
    if plan.homes:
        home = HOLD_ITEMS + len(plan.homes[uav].line_m) - 1
        home += STREAMED_ITEMS if plan.trajectories else 0
    return BEGIN_ITEMS + PHOTO_ITEMS * len(plan.routes[uav].waypoint_ids) + home


def check_mission_size(plan: Plan) -> list[Violation]:
    """One violation for each UAV whose mission no autopilot would take whole."""
    found = []
    for index, uav in enumerate(plan.uavs):
        items = mission_items(plan, index)
        if items > ITEMS_MAX:
            photos = len(plan.routes[index].waypoint_ids)
            message = (
                f"{uav.id}: its {photos} photos make a mission of {items} items, an autopilot "
                f"holds {ITEMS_MAX}: {most_photos()} photos per UAV. More UAVs (fleet.count) or "
                "fewer waypoints would do"
            )
            found.append(Violation("items", uav.id, None, None, items, ITEMS_MAX, message))
    return found


def require_missions_to_hold(waypoints: int, uavs: int) -> None:
    """Raise InfeasibleError where no division of the waypoints fits, before any search."""
    if waypoints <= uavs * most_photos():
        return
    needed = -(-waypoints // most_photos())
    raise InfeasibleError(
        f"{waypoints} waypoints do not fit into the missions of {uavs} UAV{'s' * (uavs > 1)}: a "
        f"photo takes {PHOTO_ITEMS} items, and an autopilot holds {ITEMS_MAX}, that is "
        f"{most_photos()} photos.",
        cures=(
            f"fleet.count of {needed} or more",
            f"{uavs * most_photos()} waypoints or fewer (coverage.gsd_cm, overlap_h, overlap_v)",
        ),
    )
