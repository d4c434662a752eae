"""Missions on board: upload a plan to a fleet, read it back, verify it; all or none.

    python examples/upload_missions.py [VEHICLES]

Without an argument vehicles are simulated; `udpin:0.0.0.0:14550` or
`uav1=1@udpin:0.0.0.0:14550,…` are real ones. Nothing is armed.
"""

from __future__ import annotations

import sys
from pathlib import Path

import jfto
from jfto.flight.fleet_link import Simulated, open_fleet
from jfto.planning.terrain import load_ground
from jfto_mavlink.fleet.fly import deliver_to_fleet
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.deliver import verify
from jfto_mavlink.mission.settings import settings_for

HERE = Path(__file__).parent


def main(vehicles: str = "sim") -> None:
    """Plan, upload to all vehicles at once, and compare what each of them holds."""
    scenario = jfto.load_scenario(HERE / "valley.yaml")
    plan = jfto.plan(scenario, seed=1)
    ground = load_ground(scenario).top_height  # each leg is held against the terrain
    built = build_missions(plan, settings_for(plan), ground=ground)
    missions = {each.uav: each.mission for each in built}

    simulated = Simulated(speedup=10.0 if vehicles == "sim" else 1.0)
    with open_fleet(vehicles.split(","), plan, simulated=simulated) as fleet:
        delivery = deliver_to_fleet(fleet, missions)
        release = delivery.release()  # raises an error that names every vehicle that failed
        for uav, digest in release.digests.items():
            print(f"{uav}: {len(missions[uav].items)} items on board, {digest[:12]}")

        # Later, say before take-off: does each vehicle still hold its mission?
        jobs = {
            uav: lambda context, wanted=mission: verify(context, wanted)
            for uav, mission in missions.items()
        }
        for uav, differences in fleet.run(jobs).items():
            print(f"{uav}: {differences or 'verified, item by item'}")


if __name__ == "__main__":
    main(*sys.argv[1:2])
