"""The learning curve of a training run, beside simple rules and the search.

    python bench/learning_curve.py DIR [--config config/train_rl_tp.yaml]
                                   [--csv docs/benchmarks/learning_curve.csv]
                                   [--png docs/images/learning_curve.png]

DIR is where `jfto train` kept its log. The policy's greedy lengths there are means over 96 problems
held out (W = 50, A = 4 and 8), broken rules included; "kept" is the share that breaks none. Beside
them stand, on the same problems: the nearest neighbour (the UAV that is free first takes the
nearest waypoint that the mask allows), the nearest insertion (the waypoint nearest to any route
goes where it lengthens it least) and the cheapest insertion (the waypoint that lengthens a route
least), both without the neighbour rule and without T_a,max, which can only flatter them, and the
search with 120 000 moves. A table of the same by minutes of training is printed.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import matplotlib as mpl
import numpy as np
import torch
from torch import Tensor

from jfto_planner.policy.network.environment import Episode
from jfto_planner.policy.problems import Problems
from jfto_planner.policy.training import generator
from jfto_planner.policy.training.config import IMITATION, read_training
from jfto_planner.policy.training.generator import HELD_OUT, generator_of
from jfto_planner.policy.training.imitation import solve
from jfto_planner.policy.training.trainer import HELD_OUT_EACH, HELD_OUT_SIZES, LOG

mpl.use("Agg")
import matplotlib.pyplot as plt

MOVES = 120_000
PROGRESS_ROWS = 12
COLUMNS = ("step", "seconds", "held_out", "held_out_feasible", "challenge", "replaced")


def nearest_neighbour(batch: Problems[Tensor]) -> np.ndarray:
    """Lengths (B,): the UAV that is free first takes the nearest waypoint that it may."""
    episode = Episode(batch, 1)
    for _ in range(episode.steps):
        seen = episode.observe()
        here = episode.target.gather(2, seen.active[..., None, None].expand(-1, -1, 1, 3))
        away = (batch.waypoints[:, None] - here).norm(dim=-1)
        # Stopping counts as farther than any waypoint.
        away = torch.cat([away, torch.full_like(away[..., :1], 1e6)], dim=-1)
        episode.step(torch.where(seen.allowed, away, torch.inf).argmin(-1))
    return episode.length[:, 0].numpy()


def nearest_insertion(batch: Problems[Tensor]) -> np.ndarray:
    """Lengths (B,) of open routes built by inserting what is nearest to them."""
    return np.array([_inserted(batch, row, nearest=True) for row in range(batch.size)])


def cheapest_insertion(batch: Problems[Tensor]) -> np.ndarray:
    """Lengths (B,) of open routes built by inserting what lengthens them least."""
    return np.array([_inserted(batch, row, nearest=False) for row in range(batch.size)])


def _start_points(batch: Problems[Tensor], row: int) -> Tensor:
    return batch.starts[row][batch.start_of[row]]


def _inserted(batch: Problems[Tensor], row: int, *, nearest: bool) -> float:
    points = batch.waypoints[row].numpy()
    routes = [[start] for start in _start_points(batch, row).numpy()]
    left, length = list(range(len(points))), 0.0
    while left:
        best = (np.inf, 0, 0, 0)
        # What is nearest to any node of any route, or everything that is left.
        nodes = np.concatenate([np.array(route) for route in routes])
        away = np.linalg.norm(points[left][:, None] - nodes[None], axis=-1).min(axis=1)
        open_ = [int(away.argmin())] if nearest else list(range(len(left)))
        here = points[[left[place] for place in open_]]
        for uav, route in enumerate(routes):
            nodes = np.array(route)
            away = np.linalg.norm(here[:, None] - nodes[None], axis=-1)
            legs = np.linalg.norm(np.diff(nodes, axis=0), axis=-1)
            # Between two nodes, or after the last.
            added = np.concatenate([away[:, :-1] + away[:, 1:] - legs, away[:, -1:]], axis=1)
            who, where = np.unravel_index(int(added.argmin()), added.shape)
            best = min(best, (float(added[who, where]), uav, open_[int(who)], int(where)))
        cost, uav, who, where = best
        routes[uav].insert(where + 1, points[left.pop(who)])
        length += cost
    return length


def searched(batch: Problems[Tensor]) -> np.ndarray:
    """Lengths (B,) of the search's routes in extents; nan where it found none."""
    lengths = []
    for row in range(batch.size):
        routes = solve(batch, row, MOVES, row)
        length = np.nan if routes is None else 0.0
        for uav, route in enumerate(routes or ()):
            path = torch.cat(
                [_start_points(batch, row)[uav, None], batch.waypoints[row, list(route)]]
            )
            length += float(path.diff(dim=0).norm(dim=-1).sum())
        lengths.append(length)
    return np.array(lengths)


def draw_curve(rows: list[dict[str, str]], levels: dict[str, float], warm: int, path: Path) -> None:
    """Length and share of sound plans over steps."""
    steps = [int(row["step"]) + 1 for row in rows]
    figure, axes = plt.subplots(2, 1, figsize=(8, 6), sharex=True, layout="constrained")
    axes[0].plot(
        steps, [float(row["held_out"]) for row in rows], marker=".", label="policy, greedy"
    )
    for (name, level), style in zip(levels.items(), ("--", "-.", (0, (5, 5)), ":"), strict=True):
        axes[0].axhline(level, color="0.3", linestyle=style, label=f"{name}: {level:.2f}")
    axes[0].set_ylabel("mean length / extent")
    axes[0].legend()
    broken = [100 - 100 * float(row["held_out_feasible"]) for row in rows]
    axes[1].plot(steps, broken, marker=".", color="tab:red")
    axes[1].set_ylabel("plans that break a rule / %")
    axes[1].set_ylim(0, 100)
    axes[1].set_xlabel("optimiser step")
    for axis in axes:
        axis.axvline(warm, color="0.7")
        axis.grid(alpha=0.3)
    axes[1].text(warm, 96, " REINFORCE from here", va="top")
    seconds = float(rows[-1]["seconds"])
    figure.suptitle(f"96 problems held out, W = 50, A = 4 and 8; {seconds / 60:.0f} min in all")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)


def print_progress(rows: list[dict[str, str]], search: float) -> None:
    """What training time buys: gap over the search and share of sound plans, in a dozen rows."""
    print("minutes  step  gap over the search  plans that break a rule")
    for row in rows[:: -max(1, len(rows) // PROGRESS_ROWS)][::-1]:
        gap = 100 * (float(row["held_out"]) / search - 1)
        broken = 100 - 100 * float(row["held_out_feasible"])
        minutes, step = float(row["seconds"]) / 60, int(row["step"]) + 1
        print(f"{minutes:7.1f} {step:5d} {gap:+18.1f} % {broken:22.0f} %")


def main() -> int:
    """Write the CSV and the PNG; the status is 1 if the policy does not beat nearest insertion."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("directory", type=Path)
    parser.add_argument("--config", type=Path, default=Path("config/train_rl_tp.yaml"))
    parser.add_argument("--csv", type=Path, default=Path("docs/benchmarks/learning_curve.csv"))
    parser.add_argument("--png", type=Path, default=Path("docs/images/learning_curve.png"))
    chosen = parser.parse_args()
    torch.set_num_threads(1)
    config = read_training(chosen.config)
    with (chosen.directory / LOG).open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["held_out"]]
    batches = [
        generator.draw(
            generator_of(config.seed, HELD_OUT, number), HELD_OUT_EACH, *size, config.scenes
        )
        for number, size in enumerate(HELD_OUT_SIZES)
    ]
    rules = {
        "nearest neighbour": nearest_neighbour,
        "nearest insertion": nearest_insertion,
        "cheapest insertion": cheapest_insertion,
        "search": searched,
    }
    levels = {
        name: float(np.nanmean(np.concatenate([rule(batch) for batch in batches])))
        for name, rule in rules.items()
    }
    for name, level in levels.items():
        print(f"{name:20s} {level:.3f}")
    last = float(rows[-1]["held_out"])
    gap = 100 * (last / levels["search"] - 1)
    print(f"{'policy, greedy':20s} {last:.3f}, {gap:+.1f} % over the search")
    print_progress(rows, levels["search"])
    with chosen.csv.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    warm = sum(stage.steps for stage in config.stages if stage.method == IMITATION)
    draw_curve(rows, levels, warm, chosen.png)
    return int(last >= levels["nearest insertion"])


if __name__ == "__main__":
    raise SystemExit(main())
