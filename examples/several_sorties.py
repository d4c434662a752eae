"""Several sorties: an area that one battery does not do, divided, with a plan for each flight.

    python examples/several_sorties.py [SCENARIO] [DIRECTORY]

Without arguments examples/valley.yaml is planned for small batteries, into a temporary folder.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import jfto
from jfto_msgs_py.plan_file import write_plan

HERE = Path(__file__).parent
# What stands in a data sheet, or better in a log: capacity, power to hover and to cruise.
BATTERY = {"fleet.battery_wh": 25.0, "fleet.hover_power_w": 220.0, "fleet.cruise_power_w": 250.0}


def main(scenario_file: str | None = None, directory: str | None = None) -> None:
    """Plan a scenario in as few flights as do, and say who flies how long in which."""
    overrides = {} if scenario_file else BATTERY
    scenario = jfto.load_scenario(scenario_file or HERE / "valley.yaml", overrides)
    folder = Path(directory or tempfile.mkdtemp())

    plans = jfto.plan_sorties(scenario, seed=1)
    for plan in plans:
        sortie, photos = plan.sortie, len(plan.waypoints)
        print(f"sortie {sortie.number} of {sortie.count}: {photos} photos, clean: {plan.clean}")
        for uav, route, home in zip(plan.uavs, plan.routes, plan.homes, strict=True):
            ids = " ".join(map(str, route.waypoint_ids)) or "none, a relay"
            print(f"  {uav.id} is down again after {home.landed_s:.0f} s; waypoints {ids}")
        write_plan(plan, folder / f"plan-{sortie.number}.json")
    print(f"{folder} has {len(plans)} plans: jfto check takes them together")


if __name__ == "__main__":
    main(*sys.argv[1:3])
