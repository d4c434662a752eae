"""Fleet uploads over lossy links: does a wrong mission ever get released, and how long it takes.

Each round sends a new random mission of 60 items to each of 3 simulated vehicles at once, over
links that lose a share of the frames in each direction, and reads it back. What each vehicle really
holds is then looked up in its storage. Times are virtual seconds of the vehicles' own clocks, so
they do not depend on the computer; same seed, same figures.

    python bench/upload.py [--rounds 200] [--loss 0 0.1 0.3] [--seed 1]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "test"))

from jfto_mavlink.fleet.fly import FleetDelivery, deliver_to_fleet
from jfto_mavlink.mission.stored import stored
from jfto_mavlink.protocol.item import Item, Mission
from jfto_sim import LinkFaults, Vehicle, VehicleConfig
from support.rehearsal import Rehearsal

ITEMS, VEHICLES = 60, 3


def random_mission(rng: np.random.Generator) -> Mission:
    """Take-off, waypoints each with camera items, return: 60 items, home included."""
    items = [Item(16, 0, x=473_977_420, y=85_455_940, z=488.1), Item(22, 3, z=10.0)]
    while len(items) < ITEMS - 1:
        x = 473_977_420 + int(rng.integers(-90_000, 90_000))
        y = 85_455_940 + int(rng.integers(-90_000, 90_000))
        pitch, yaw = -float(rng.integers(10, 80)), float(rng.integers(0, 360))
        items += [
            Item(205, 2, (pitch, 0.0, 0.0, 0.0)),
            Item(115, 2, (yaw, 0.0, 0.0, 0.0)),
            Item(
                16, 3, (float(rng.integers(0, 3)), 0.0, 0.0, 0.0), x, y, float(rng.integers(20, 90))
            ),
            Item(203, 2, x=1),
        ]
    return Mission((*items[: ITEMS - 1], Item(20, 2)))


def holds(vehicle: Vehicle, mission: Mission) -> bool:
    """Whether a vehicle's storage holds exactly this mission (its home aside)."""
    on_board = [
        stored(Item(i.command, i.frame, i.params, i.x, i.y, i.z_m)) for i in vehicle.store.mission
    ]
    wanted = [stored(item) for item in mission.items]
    return len(on_board) == len(wanted) and all(
        a.matches(b) for a, b in zip(on_board[1:], wanted[1:], strict=True)
    )


def measure(loss: float, rounds: int, seed: int) -> dict[str, float]:
    """Figures of one loss rate."""
    faults = LinkFaults(loss=loss)
    vehicles = {f"uav{n}": Vehicle(VehicleConfig(sysid=n)) for n in range(1, VEHICLES + 1)}
    runner = Rehearsal(vehicles, to_vehicle=faults, from_vehicle=faults, seed=seed)
    runner.advance(5.0)
    rng = np.random.default_rng(seed)
    times, refused, wrong = [], 0, 0
    for _ in range(rounds):
        missions = {uav: random_mission(rng) for uav in vehicles}
        begun_s = runner.now_s
        outcome: FleetDelivery = deliver_to_fleet(runner, missions)
        times.append(runner.now_s - begun_s)
        refused += bool(outcome.failed)
        wrong += sum(not holds(vehicles[uav], missions[uav]) for uav in outcome.delivered)
    return {
        "released": rounds - refused,
        "refused": refused,
        "wrong": wrong,
        "median_s": statistics.median(times),
        "p95_s": float(np.quantile(times, 0.95)),
        "worst_s": max(times),
    }


def main() -> int:
    """Print one line per loss rate; the status is 1 if a wrong mission was released."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=200)
    parser.add_argument("--loss", type=float, nargs="+", default=[0.0, 0.1, 0.3])
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(f"{options.rounds} uploads of {ITEMS} items to {VEHICLES} vehicles; virtual seconds")
    print("loss each way  released  refused  wrong   median     p95   worst   (computer time)")
    status = 0
    for loss in options.loss:
        begun = time.perf_counter()
        found = measure(loss, options.rounds, options.seed)
        spent = time.perf_counter() - begun
        print(
            f"{loss:12.0%}  {found['released']:8d}  {found['refused']:7d}  {found['wrong']:5d}"
            f"  {found['median_s']:6.2f} s  {found['p95_s']:5.1f} s  {found['worst_s']:5.1f} s"
            f"   ({spent:.0f} s)",
            flush=True,
        )
        status |= int(found["wrong"] > 0)
    return status


if __name__ == "__main__":
    sys.exit(main())
