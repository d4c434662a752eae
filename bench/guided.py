"""Guided flights through `jfto run`, each at a load of its own: do all come home, how true?

Each run plans once, flies in real time beside a number of busy programs, and is held against its
curves: RMS of the distance of each UAV from where it should have been, from the moment it has left
its pad to the end of its curve, later by what the fleet was later.

    python bench/guided.py config/small.yaml --runs 10 -o bench-guided
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from jfto.analysis.motion import motions
from jfto.analysis.read_bag import read_flight
from jfto.pipeline.directory import FLIGHT_NAME, PLAN_NAME, flight_bags
from jfto_msgs_py.plan_file import read_plan

GREATEST_LOAD = 8
WANTED_RMS_M = 0.6
# Before it is so high above its pad and so far from it, a vehicle waits above its curve.
DEPARTED_M = 20.0
LIMIT_S = 1800.0


@dataclass(frozen=True)
class Flown:
    """One run: at which load, how it ended, waypoints visited, worst lateness, RMS of each UAV."""

    run: int
    load: int
    ended: str
    visited: str
    worst_late_s: float
    rms_m: tuple[float, ...]

    @property
    def good(self) -> bool:
        """Whether it came to its end, and close enough to its curves."""
        return self.ended == "landed" and max(self.rms_m) <= WANTED_RMS_M


@contextmanager
def load(count: int) -> Iterator[None]:
    """So many programs that do nothing but take time."""
    programs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for program in programs:
            program.kill()
            program.wait()


def rms_m(directory: Path, late_s: float) -> tuple[float, ...]:
    """RMS distance of each UAV from its curve, `late_s` after its time, m."""
    plan = read_plan(directory / PLAN_NAME)
    flight = read_flight(flight_bags(directory), plan)
    found = []
    for uav, motion in zip(plan.uavs, motions(plan), strict=True):
        track = flight.tracks[uav.id]
        away = np.linalg.norm(motion.position_m - np.array(uav.start_m), axis=1)
        begin_s = float(motion.times_s[int(np.argmax(away > DEPARTED_M))])
        at_s = track.times_s - late_s
        chosen = (at_s > begin_s) & (at_s < motion.times_s[-1])
        wanted = np.stack(
            [np.interp(at_s[chosen], motion.times_s, axis) for axis in motion.position_m.T], axis=1
        )
        error = np.linalg.norm(track.position_m[chosen] - wanted, axis=1)
        found.append(float(np.sqrt(np.mean(error**2))))
    return tuple(found)


def fly(scene: Path, plan: Path, directory: Path, number: int, busy: int) -> Flown:
    """One run at a load; exits with what `jfto run` says where it does not fly."""
    command = [sys.executable, "-m", "jfto", "run", str(scene), "--plan", str(plan)]
    command += ["--set", "trajectory.mode=guided", "-o", str(directory), "--json"]
    with load(busy):
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    printed = json.loads(done.stdout) if done.stdout else {"problems": [done.stderr]}
    facts = printed.get("flight")
    if facts is None:
        sys.exit("\n".join(printed.get("problems", [done.stderr])))
    waypoints = json.loads((directory / FLIGHT_NAME).read_text())["waypoints"]
    late = [one["late_s"] for one in waypoints["passages"] if one["late_s"] is not None]
    lateness_s = float(np.median(late)) if late and max(late) > 1.0 else 0.0
    return Flown(
        number,
        busy,
        facts["ended"],
        f"{waypoints['visited']}/{waypoints['count']}",
        waypoints["worst_late_s"],
        rms_m(directory, lateness_s),
    )


def main() -> int:
    """Fly, print a line each, and say whether all were good."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path)
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-o", "--out", type=Path, default=Path("bench-guided"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    plan, chance = given.out / "plan.json", random.Random(given.seed)
    planning = [sys.executable, "-m", "jfto", "plan", str(given.scene), "-o", str(plan)]
    subprocess.run([*planning, "--set", "trajectory.mode=guided"], check=True)
    flown = []
    for number in range(1, given.runs + 1):
        busy = chance.randint(0, GREATEST_LOAD)
        flown.append(fly(given.scene, plan, given.out / f"run-{number}", number, busy))
        last = flown[-1]
        worst = max(last.rms_m)
        print(
            f"run {number}: load {busy}, {last.ended}, {last.visited} waypoints, worst "
            f"{last.worst_late_s:+.1f} s, RMS {min(last.rms_m):.2f}–{worst:.2f} m",
            flush=True,
        )
    (given.out / "flown.json").write_text(json.dumps([asdict(one) for one in flown], indent=1))
    good = sum(one.good for one in flown)
    print(f"{good} of {len(flown)} runs landed with at most {WANTED_RMS_M} m RMS")
    return 0 if good == len(flown) else 1


if __name__ == "__main__":
    raise SystemExit(main())
