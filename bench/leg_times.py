"""Predicted against recorded leg times of ArduCopter missions: `python bench/leg_times.py`.

Prints, for each of the 19 recorded flights of the 20-waypoint mission, the mean and largest error
per leg and the error of the total, for the planner's closed form and for the closed loop; then the
same over the variants of the short courses. Exit status 1 if a flight is missed by more than 0.2 s
mean, 0.9 s in a leg or 1 % in all.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "test"))

from data.timing import flights
from jfto_world.motion.arducopter import fly_route, plan_target

REMARKS = {
    "c": "spline waypoints",
    "c_v8": "spline waypoints",
    "a_wind5": "wind, tilt limit binds",
    "a_v8_wind5": "wind, tilt limit binds",
    "a_v8_wind8": "wind, tilt limit binds",
    "a_ang20": "tilt limit binds",
}
# largest error: mean and greatest per leg in s, of a whole mission as a share
MEAN_S, MOST_S, MISSION = 0.2, 0.9, 0.01


def errors(predicted: np.ndarray, measured: np.ndarray) -> str:
    away = np.abs(predicted - measured)
    total = predicted.sum() - measured.sum()
    share = 100 * total / measured.sum()
    return f"{away.mean():6.3f} {away.max():6.2f} {total:+7.2f} s {share:+6.2f} %"


def keeps(predicted: np.ndarray, measured: np.ndarray) -> bool:
    away = np.abs(predicted - measured)
    total = abs(predicted.sum() / measured.sum() - 1.0)
    return bool(away.mean() <= MEAN_S and away.max() <= MOST_S and total <= MISSION)


def mission() -> int:
    route = flights.mission_route()
    print("20-waypoint mission: leg error mean, max [s]; total error")
    print(f"{'run':22s}{'measured':>9s}   {'planner':34s}   closed loop")
    fly_route(route, flights.wpnav_of(""))
    spent, kept, runs = 0.0, 0, flights.runs()
    for name, (parameters, measured, _, _) in runs.items():
        hold = np.full(21, 1.0) if name.startswith("d") else None
        planner = ""
        if not name.startswith("c"):
            wpnav = flights.wpnav_of(parameters)
            planner = errors(np.diff(plan_target(route, wpnav, hold_s=hold).reached_s), measured)
        begin = time.perf_counter()
        flown = flights.flown_leg_times(name)
        spent += time.perf_counter() - begin
        kept += keeps(flown, measured)
        print(f"{name:22s}{measured.sum():8.1f} s   {planner:34s}   {errors(flown, measured)}   "
              f"{REMARKS.get(name, '')}")  # fmt: skip
    print(f"closed loop of {len(runs)} missions: {spent:.2f} s")
    print(f"within {MEAN_S} s mean, {MOST_S} s per leg and {MISSION:.0%}: {kept} of {len(runs)}")
    return int(kept < len(runs))


def courses() -> None:
    north = [0.0, 100.0, 100.0, 186.6, 286.6, 200.0]
    east = [0.0, 0.0, 100.0, 150.0, 150.0, 100.0]
    route = np.column_stack([east, north, np.full(6, 40.0)])
    table: dict[str, list[dict[str, str]]] = {}
    for row in flights.rows("course5_variants.csv"):
        table.setdefault(row["variant"], []).append(row)
    planner, loop, count = [], [], 0
    for name, rows in table.items():
        other = ("spline", "change_speed", "nav_delay", "loiter", "slope")
        if name.startswith(other) or len(rows) != 5:
            continue
        hold = 2.0 if name.startswith("hold2") else 1.0 if "hold1" in name else 0.0
        wpnav = flights.wpnav_of(rows[0]["parameters"])
        measured = np.array([float(r["leg_time_s"]) for r in rows])
        holds = np.full(6, hold)
        planner.append(np.diff(plan_target(route, wpnav, hold_s=holds).reached_s) - measured)
        loop.append(np.diff(fly_route(route, wpnav, hold_s=holds).reached_s) - measured)
        count += 1
    print(f"\n{count} variants of the level 5-waypoint course: leg error mean, max [s]")
    for label, found in (("planner", planner), ("closed loop", loop)):
        away = np.abs(np.array(found))
        print(f"{label:12s} {away.mean():.3f} {away.max():.2f}")


if __name__ == "__main__":
    status = mission()
    courses()
    raise SystemExit(status)
