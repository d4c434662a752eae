"""A plan's missions flown one after the other: photographs counted and held against waypoints.

Simulated vehicles, or a real ArduCopter where JFTO_ARDUCOPTER names its binary. Places and headings
are those of CAMERA_FEEDBACK.

    python bench/photographs.py PLAN
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "test"))

from jfto_mavlink.mission.build import VehicleMission, build_missions
from jfto_mavlink.mission.settings import settings_for
from jfto_msgs_py.plan_file import read_plan
from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.geodesy import wrap_180
from jfto_sim.mission.items import Item
from jfto_world.terrain.frame import LocalFrame
from support.arducopter import binary
from support.pilot import Pilot
from support.vehicles import Starter

SPEEDUP, LIMIT_S = 6.0, 3000.0


def fly(mission: VehicleMission, sysid: int, frame: LocalFrame) -> list[tuple[np.ndarray, float]]:
    """Places (ENU) and headings (deg) of the photographs of one vehicle, in order."""
    lat, lon, alt_m = mission.home_deg_m
    config = VehicleConfig(
        sysid=sysid, home_lat_deg=lat, home_lon_deg=lon, home_alt_m=alt_m,
        parameters={"CAM1_TYPE": 1},
    )  # fmt: skip
    with ExitStack() as closing:
        if binary() is None:
            pilot = Pilot(Vehicle(config), port=1)
        else:
            folder = Path(closing.enter_context(tempfile.TemporaryDirectory()))
            pilot = Starter(folder, closing)([config], speedup=SPEEDUP).pilot(1)
        pilot.ready()
        for name, value in mission.mission.parameters:
            pilot.set_parameter(name, value)
        pilot.upload(
            [Item(i.command, i.frame, i.params, i.x, i.y, i.z) for i in mission.mission.items]
        )
        pilot.command(176, 1, 4)
        pilot.command(400, 1)
        pilot.command(300)
        end = f"Reached command #{mission.item_map.items[-1]}"
        pilot.wait(lambda m: m.get_type() == "STATUSTEXT" and m.text == end, LIMIT_S)
        pilot.run(2.0)
        shots = [h.message for h in pilot.heard if h.message.get_type() == "CAMERA_FEEDBACK"]
    return [(np.array(frame.to_enu(m.lat / 1e7, m.lng / 1e7, m.alt_msl)), m.yaw) for m in shots]


def main() -> None:
    """Print what each vehicle photographed, and how far from its waypoints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("plan", type=Path)
    plan = read_plan(parser.parse_args().plan)
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    apart, turned = [], []
    for number, mission in enumerate(build_missions(plan, settings_for(plan)), 1):
        if not mission.waypoint_ids:
            continue
        planned = [w for w in map(by_id.__getitem__, mission.waypoint_ids) if w.photo]
        photos = fly(mission, number, LocalFrame(plan.origin))
        print(f"{mission.uav}: {len(photos)} photos of {len(planned)}")
        for (place, yaw_deg), waypoint in zip(photos, planned, strict=True):
            apart.append(math.dist(place, waypoint.position_m))
            turned.append(abs(wrap_180(yaw_deg - waypoint.yaw_deg)))
    print(f"from waypoints: mean {np.mean(apart):.2f} m, worst {max(apart):.2f} m")
    print(f"heading: worst {max(turned):.1f}°")


if __name__ == "__main__":
    main()
