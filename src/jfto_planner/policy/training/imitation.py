"""The warm start: routes that the search finds, kept on disk, and raising their likelihood."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from pathlib import Path

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.kernel.replay import fly_routes
from jfto_planner.policy.network.model import Policy
from jfto_planner.policy.problems import Problems, problem_of
from jfto_planner.policy.training.config import Stage, TrainingConfig
from jfto_planner.policy.training.generator import TEACHER, between, draw, generator_of
from jfto_planner.routing.annealer import Annealer
from jfto_planner.routing.settings import SearchSettings

FOLDER = "teacher"
# The search checks its routes exactly at this many instants; a plan's 150 would take most of the
# time here, and what slips through is one choice that the policy's mask forbids.
INSTANTS = 30
# Shards are numbered apart from stage to stage.
MOST_SHARDS = 1_000_000
# Share of a stage's steps after which all its shards are in use; until then their number grows, so
# that they can be made beside the training.
GROWTH = 0.9
# Lateness, in units of extent over speed, that single precision alone can cause.
ROUNDING = 1e-5


@dataclass(frozen=True)
class Shard:
    """Problems of one size with the routes to imitate, `routes` (B, A, L): waypoints in order of
    visit, then W. `solved` (B,) says where the search found sound routes.
    """

    batch: Problems[Tensor]
    routes: Tensor
    solved: Tensor


class Teacher:
    """The shards of a run, each drawn and solved when first asked for."""

    def __init__(self, config: TrainingConfig, directory: Path) -> None:
        self.config = config
        self.folder = directory / FOLDER

    def shard(self, stage: int, number: int) -> Shard:
        """Shard of a stage, from the disk where it is there. Raises InputError if it is damaged."""
        batch, seed = self._problems(stage, number)
        path = self.folder / f"stage{stage}_{number:05d}.safetensors"
        if not path.exists():
            self._solve(batch, seed, self.config.stages[stage].moves, path)
        try:
            tensors = load_file(path)
        except (OSError, SafetensorError) as error:
            raise InputError(f"{path}: cannot be read ({error}); delete it.") from error
        return Shard(batch, tensors["routes"].long(), tensors["solved"].bool())

    def _problems(self, stage: int, number: int) -> tuple[Problems[Tensor], int]:
        settings = self.config.stages[stage]
        random = generator_of(self.config.seed, TEACHER, stage * MOST_SHARDS + number)
        waypoints = between(settings.sizes(number), random)
        uavs = between(settings.uavs, random)
        count = settings.problems(waypoints)
        batch = draw(random, count, waypoints, uavs, self.config.scenes)
        return batch, random.initial_seed()

    def _solve(self, batch: Problems[Tensor], seed: int, moves: int, path: Path) -> None:
        waypoints, uavs = batch.waypoints.shape[1], batch.start_of.shape[1]
        routes = torch.full((batch.size, uavs, waypoints), waypoints, dtype=torch.int16)
        solved = torch.zeros(batch.size, dtype=torch.uint8)
        for row in range(batch.size):
            found = solve(batch, row, moves, seed + row)
            solved[row] = found is not None
            for uav, route in enumerate(found or ()):
                routes[row, uav, : len(route)] = torch.tensor(route, dtype=torch.int16)
        self.folder.mkdir(parents=True, exist_ok=True)
        draft = path.with_name(f"{path.name}.{os.getpid()}.tmp")
        save_file({"routes": routes, "solved": solved}, draft)
        draft.replace(path)


def solve(
    batch: Problems[Tensor], row: int, moves: int, seed: int
) -> tuple[tuple[int, ...], ...] | None:
    """Sound routes for one problem by one short run of the search, or None."""
    problem = problem_of(batch, row, slots=INSTANTS)
    settings = SearchSettings(moves=moves, starts=1, workers=1)
    annealer = Annealer(problem, settings, seed % 2**63, None)
    found = annealer.run(lambda done: done / moves, lambda: False, lambda *_: None)
    return found.routes


def ready_shards(stage: Stage, within: int) -> int:
    """How many shards the stage's step of a number may draw from."""
    share = (within + 1) / (GROWTH * stage.steps)
    return min(stage.shards, math.ceil(stage.shards * share))


def imitate(
    policy: Policy, batch: Problems[Tensor], routes: Tensor
) -> tuple[Tensor, dict[str, float]]:
    """Mean negative log likelihood per choice of given routes (B, A, L), and its log row.

    The UAVs choose in the order in which they are free, as in a rollout.
    """
    device = batch.waypoints.device
    flown, chosen = fly_routes(batch.numpy(), routes.numpy())
    seen, choices = flown.seen.tensors().to(device), torch.from_numpy(chosen).to(device)
    # The mask looks at the neighbour rule at other instants than the search does.
    allowed = seen.allowed.scatter(-1, choices.flatten(1)[..., None], True)
    seen = replace(seen, allowed=allowed)
    loss = -policy.log_likelihood(policy.encode(batch), seen, choices).mean() / choices.shape[-1]
    clean = (flown.misses == 0) & (flown.late <= ROUNDING)
    return loss, {
        "waypoints": batch.waypoints.shape[1],
        "uavs": batch.start_of.shape[1],
        "length": float(flown.length.mean()),
        "misses": float(flown.misses.mean()),
        "late": float(flown.late.mean()),
        "feasible": float(clean.mean()),
        "loss": float(loss.detach()),
    }
