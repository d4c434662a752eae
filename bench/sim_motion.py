"""Fly the recorded missions in the simulator and print leg-time and track errors.

Usage: python bench/sim_motion.py TIMING_FOLDER [RUN ...]
"""

from __future__ import annotations

import argparse
import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "test"))

from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.dialect import mavlink
from jfto_sim.geodesy import move
from jfto_sim.mission.items import Item
from jfto_sim.modes.mode import Mode
from support.pilot import Pilot

HOME = (466_000_000, 85_000_000)


@dataclass(frozen=True)
class Run:
    """One recorded run of the 20-waypoint mission."""

    name: str
    parameters: dict[str, float]
    hold_s: float = 0.0
    photo: bool = False
    track: str = ""


RUNS = (
    Run("a1", {}, track="mission20_a_plain_run1_5hz.csv"),
    Run("a_v8", {"WPNAV_SPEED": 800}, track="mission20_a_plain_v8_5hz.csv"),
    Run("a_v5", {"WPNAV_SPEED": 500}),
    Run("a_v8_jerk4", {"WPNAV_SPEED": 800, "WPNAV_JERK": 4}),
    Run("a_ang20", {"ANGLE_MAX": 2000}, track="mission20_a_plain_anglemax20_5hz.csv"),
    Run("a_ang45", {"ANGLE_MAX": 4500}),
    Run(
        "a_v6_up4_dn3_az2_r5",
        {"WPNAV_SPEED": 600, "WPNAV_SPEED_UP": 400, "WPNAV_SPEED_DN": 300, "WPNAV_ACCEL_Z": 200,
         "WPNAV_RADIUS": 500},
    ),
    Run("a_wind5", {"SIM_WIND_SPD": 5, "SIM_WIND_DIR": 270},
        track="mission20_a_plain_wind5_5hz.csv"),
    Run("b", {}, photo=True, track="mission20_b_photo_items_5hz.csv"),
    Run("b_v8_up5_dn3", {"WPNAV_SPEED": 800, "WPNAV_SPEED_UP": 500, "WPNAV_SPEED_DN": 300},
        photo=True),
    Run("d", {}, hold_s=1.0, track="mission20_d_hold1_5hz.csv"),
    Run("d_v8", {"WPNAV_SPEED": 800}, hold_s=1.0),
    Run("d_photo_v8", {"WPNAV_SPEED": 800}, hold_s=1.0, photo=True,
        track="mission20_d_hold1_photo_items_v8_5hz.csv"),
)  # fmt: skip


def mission(folder: Path, run: Run) -> tuple[list[Item], list[int]]:
    """Items, and the sequence number of each waypoint."""
    items = [Item(16, 0, (0, 0, 0, 0), *HOME, 488.0)]
    seqs = []
    yaws = _photo_yaws(folder, run.name)
    with (folder / "mission20_waypoints.csv").open() as file:
        for row in csv.DictReader(file):
            lat, lon = move(*HOME, float(row["east_m"]), float(row["north_m"]))
            seqs.append(len(items))
            items.append(Item(16, 6, (run.hold_s, 0, 0, 0), lat, lon, float(row["height_m"])))
            if run.photo:
                items.append(Item(203, 2, (0, 0, 0, 0), 1, 0, 0.0))
                items.append(Item(205, 2, (-45, 0, 0, 0)))
                yaw = yaws.get(int(row["wp"]) + 1)
                if yaw is not None:
                    items.append(Item(115, 2, (yaw, 0, 0, 0)))
    return items, seqs


def _photo_yaws(folder: Path, name: str) -> dict[int, float]:
    """Heading at each waypoint's shutter in a recorded photo run."""
    with (folder / "camera_feedback.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["run"] == name]
    return {int(row["wp"]): float(row["vehicle_yaw_deg"]) % 360 for row in rows}


def fly(folder: Path, run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Returns the leg times (20,) and the track (K, 4): time in AUTO, east, north, up."""
    vehicle = Vehicle(
        VehicleConfig(
            home_lat_deg=46.6, home_lon_deg=8.5, home_alt_m=488.0, parameters=run.parameters
        )
    )
    pilot = Pilot(vehicle)
    pilot.take_off(60.0)
    pilot.run(10.0)
    items, seqs = mission(folder, run)
    assert pilot.upload(items) == 0
    pilot.send(mavlink.MAVLink_set_mode_message(1, 1, Mode.AUTO))
    while vehicle.mode.number != Mode.AUTO:
        pilot.run(0.005)
    begin = vehicle.time_s
    track, reached = [], {}
    last = f"Reached command #{seqs[-1]}"
    while last not in reached and vehicle.time_s - begin < 900:
        for heard in pilot.run(0.02):
            if heard.message.get_type() == "STATUSTEXT":
                reached[heard.message.text] = heard.time_s - begin
        track.append((vehicle.time_s - begin, *vehicle.body.position_m))
    times = [reached[f"Reached command #{seq}"] for seq in seqs]
    return np.diff([0.0, *times]), np.array(track)


def main() -> None:
    """Fly, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("run", nargs="*")
    args = parser.parse_args()
    measured: dict[str, list[float]] = {}
    with (args.folder / "mission20_leg_times.csv").open() as file:
        for row in csv.DictReader(file):
            measured.setdefault(row["run"], []).append(float(row["measured_s"]))
    print(
        "run                    leg error mean / max, s   total measured / flown, s   track RMS, m"
    )
    for run in RUNS:
        if args.run and run.name not in args.run:
            continue
        legs, track = fly(args.folder, run)
        truth = np.array(measured[run.name])
        error = np.abs(legs - truth)
        rms = ""
        if run.track:
            table = np.genfromtxt(args.folder / run.track, delimiter=",", names=True)
            at = table["time_in_auto_s"]
            at = at[at <= track[-1, 0]]
            flown = np.stack([np.interp(at, track[:, 0], track[:, k]) for k in (1, 2, 3)], -1)
            real = np.stack(
                [table[c][: len(at)] for c in ("east_m", "north_m", "up_estimated_m")], -1
            )
            rms = f"{np.sqrt(np.mean(np.sum((flown - real) ** 2, -1))):.2f}"
        print(
            f"{run.name:22} {error.mean():6.3f} / {error.max():5.2f} "
            f"{truth.sum():16.1f} / {legs.sum():.1f} {rms:>14}", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    main()
