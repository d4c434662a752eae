"""Items that the photographs of plans take, by the way that cameras are turned.

Without what a mission begins and ends with; "before" is what each photograph took until 2026-12-01.

    python bench/mission_items.py PLAN…
"""

from __future__ import annotations

import argparse
from pathlib import Path

from jfto_msgs_py.plan_file import read_plan
from jfto_msgs_py.records.plan import Plan
from jfto_world.mission.encoding import Encoding
from jfto_world.mission.steps import mission_items, route_steps

BEFORE = 4


def items_each(plan: Plan, mount: str) -> float:
    """Items per photograph of all routes together."""
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    items = photos = 0
    for route in plan.routes:
        waypoints = [by_id[number] for number in route.waypoint_ids]
        encoding = Encoding(mount)
        items += len(
            route_steps(waypoints, route.arrival_s, route.lines, encoding, plan.trigger).steps
        )
        photos += sum(waypoint.photo for waypoint in waypoints)
    return items / max(photos, 1)


def main() -> None:
    """Print one row per plan."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("plans", nargs="+", type=Path)
    print("plan, photos, on lines, before, by angles, look_at, longest mission")
    for path in parser.parse_args().plans:
        plan = read_plan(path)
        photos = sum(waypoint.photo for waypoint in plan.waypoints)
        lines = sum(line.last - line.first + 1 for route in plan.routes for line in route.lines)
        angles, look = items_each(plan, "mount_control"), items_each(plan, "look_at")
        longest = max(mission_items(plan, a) for a in range(len(plan.uavs)))
        print(f"{path}, {photos}, {lines}, {BEFORE:.2f}, {angles:.2f}, {look:.2f}, {longest}")


if __name__ == "__main__":
    main()
