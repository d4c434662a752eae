"""Routes to imitate: what the search finds for random problems in a short time, kept on disk."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.problems import Problems, problem_of
from jfto_planner.policy.training import generator as scenes
from jfto_planner.policy.training.config import IMITATION, TrainingConfig
from jfto_planner.policy.training.seeds import TEACHER, between, generator_of
from jfto_planner.routing.annealer import Annealer
from jfto_planner.routing.settings import SearchSettings

FOLDER = "teacher"
# The search checks its routes exactly at this many instants; a plan's 150 would take most of the
# time here, and what slips through is one choice that the policy's mask forbids.
INSTANTS = 30
# Shards are numbered apart from stage to stage.
MOST_SHARDS = 1_000_000


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

    def make_all(self) -> None:
        """Make what is missing of all shards, in the order in which training asks for them."""
        for stage, settings in enumerate(self.config.stages):
            if settings.method == IMITATION:
                for number in range(settings.shards):
                    self.shard(stage, number)

    def _problems(self, stage: int, number: int) -> tuple[Problems[Tensor], int]:
        settings = self.config.stages[stage]
        random = generator_of(self.config.seed, TEACHER, stage * MOST_SHARDS + number)
        waypoints = between(settings.sizes(number), random)
        uavs = between(settings.uavs, random)
        count = settings.problems(waypoints)
        batch = scenes.draw(random, count, waypoints, uavs, self.config.scenes)
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
