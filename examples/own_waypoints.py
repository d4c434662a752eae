"""Your own waypoints: routes over places from a CSV, GeoJSON or QGroundControl file.

    python examples/own_waypoints.py [FILE]

Without an argument examples/waypoints.csv is flown over. Columns are `lat,lon` and `alt` (in the
terrain's datum) or `agl_m` (above ground); `yaw_deg` and `pitch_deg` may be left out.
"""

from __future__ import annotations

import sys
from pathlib import Path

import jfto

HERE = Path(__file__).parent


def main(waypoint_file: str | None = None) -> None:
    """Share the waypoints of a file out over three UAVs that stay in touch."""
    path = Path(waypoint_file or HERE / "waypoints.csv").resolve()
    scenario = jfto.load_scenario(
        HERE / "valley.yaml", {"waypoints.source": "file", "waypoints.file": str(path)}
    )
    plan = jfto.plan(scenario, seed=1)
    print(f"{path.name}: {len(plan.waypoints)} waypoints, {plan.total_length_m:.0f} m in all")
    for uav, route in zip(plan.uavs, plan.routes, strict=True):
        stops = ", ".join(
            f"{number} at {second:.0f} s"
            for number, second in zip(route.waypoint_ids, route.arrival_s, strict=True)
        )
        print(f"{uav.id}: {stops or 'stays on its pad and relays'}")

    topology = jfto.topology(plan)
    neighbours = topology.adjacency.sum(axis=2)
    print(f"neighbours per UAV and slot: {neighbours.min()} to {neighbours.max()}")
    print(f"in one piece throughout: {bool(topology.connected.all())}")


if __name__ == "__main__":
    main(*sys.argv[1:2])
