"""The training loop (Algorithm 1): draw, roll out, update, challenge the best model."""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor

from jfto_msgs_py.errors import InputError
from jfto_planner.policy import generator as scenes
from jfto_planner.policy.instance import InstanceBatch
from jfto_planner.policy.model import Policy, Rollouts
from jfto_planner.policy.training import checkpoint
from jfto_planner.policy.training.baseline import BestModel, greedy_cost
from jfto_planner.policy.training.config import Stage, TrainingConfig
from jfto_planner.policy.training.workers import Workers

CHECKPOINT = "checkpoint.safetensors"
LOG = "log.csv"
COLUMNS = (
    "step",
    "waypoints",
    "uavs",
    "length",
    "misses",
    "late",
    "feasible",
    "gradient",
    "evaluation",
    "replaced",
)
# Streams of random numbers that must not meet: one for training, one for evaluation problems.
TRAINING, EVALUATION = 0, 1


@dataclass(frozen=True)
class Progress:
    """What a callback is told after each step."""

    step: int
    total: int
    row: dict[str, float]


def _generator(config: TrainingConfig, stream: int, number: int, rank: int) -> torch.Generator:
    """Random numbers of one step of one worker: a function of these alone, so that a run that is
    resumed draws what the run that was killed would have drawn.
    """
    mixed = ((config.seed * 2 + stream) * 1_000_003 + number) * 64 + rank
    return torch.Generator().manual_seed(mixed % 2**63)


class Trainer:
    """One training run in a directory; continues where a checkpoint there left off."""

    def __init__(self, config: TrainingConfig, directory: Path, device: str = "cpu") -> None:
        self.config = config
        self.directory = directory
        self.device = torch.device(device)
        self.workers = Workers()
        directory.mkdir(parents=True, exist_ok=True)
        torch.manual_seed(config.seed)
        self.policy = Policy(config.shape).to(self.device)
        self.optimiser = torch.optim.Adam(self.policy.parameters())
        self.best = BestModel(self.policy, config, self._evaluation_problems)
        self.step = 0
        if (directory / CHECKPOINT).exists():
            self._resume()

    def run(self, report: Callable[[Progress], None] | None = None) -> Policy:
        """Train to the end of the last stage; the best model. Ctrl-C keeps the last checkpoint."""
        self._truncate_log()
        rows: list[dict[str, float]] = []
        while self.step < self.config.total_steps:
            rows.append(self._one_step())
            self.step += 1
            if report:
                report(Progress(self.step, self.config.total_steps, rows[-1]))
            if (
                self.step % self.config.checkpoint_every == 0
                or self.step == self.config.total_steps
            ):
                self._append_log(rows)
                rows = []
                self._save()
        return self.best.model

    def _one_step(self) -> dict[str, float]:
        config = self.config
        stage = config.stage_at(self.step)
        batch, generator = self._draw(stage)
        for group in self.optimiser.param_groups:
            group["lr"] = stage.learning_rate
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.device.type == "cuda"):
            outcome = self.policy(
                batch, stage.rollouts, generator=generator, first=self._first(batch, stage)
            )
        cost = outcome.cost(config.miss_penalty, config.late_penalty).detach()
        advantage = cost - self._baseline(batch, cost)
        loss = (advantage * outcome.log_likelihood).mean()
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        self.workers.average_gradients(self.policy)
        norm = torch.nn.utils.clip_grad_norm_(self.policy.parameters(), config.gradient_clip)
        self.optimiser.step()
        return self._row(batch, outcome, float(norm))

    def _draw(self, stage: Stage) -> tuple[InstanceBatch, torch.Generator]:
        # All workers draw problems of one size, so that their steps take equally long.
        common = _generator(self.config, TRAINING, self.step, 63)
        waypoints = _between(stage.waypoints, common)
        uavs = _between(stage.uavs, common)
        own = _generator(self.config, TRAINING, self.step, self.workers.rank)
        batch = scenes.draw(own, stage.instances, waypoints, uavs, self.config.scenes)
        sampling = own
        if self.device.type != "cpu":
            sampling = torch.Generator(self.device).manual_seed(own.initial_seed() + 1)
        return batch.to(self.device), sampling

    def _first(self, batch: InstanceBatch, stage: Stage) -> Tensor | None:
        if not self.config.multi_start:
            return None
        number = torch.arange(stage.rollouts, device=self.device)
        return number.remainder(batch.waypoints.shape[1]).expand(batch.size, -1)

    def _baseline(self, batch: InstanceBatch, cost: Tensor) -> Tensor:
        if self.config.baseline == "shared":
            return cost.mean(1, keepdim=True)
        return greedy_cost(self.best.model, [batch], self.config).to(cost)[:, None]

    def _row(self, batch: InstanceBatch, outcome: Rollouts, norm: float) -> dict[str, float]:
        clean = (outcome.misses == 0) & (outcome.late == 0)
        row: dict[str, float] = {
            "step": self.step,
            "waypoints": batch.waypoints.shape[1],
            "uavs": batch.start_of.shape[1],
            "length": float(outcome.length.mean()),
            "misses": float(outcome.misses.mean()),
            "late": float(outcome.late.mean()),
            "feasible": float(clean.float().mean()),
            "gradient": norm,
            "evaluation": float("nan"),
            "replaced": 0,
        }
        if (self.step + 1) % self.config.evaluate_every == 0:
            self.workers.share_buffers(self.policy)
            row["evaluation"], row["replaced"] = self.best.challenge(self.policy)
        return row

    def _evaluation_problems(self, number: int) -> list[InstanceBatch]:
        """Problems that the best model is judged by: the sizes of every stage in equal parts."""
        generator = _generator(self.config, EVALUATION, number, 0)
        count = max(2, self.config.evaluation_instances // len(self.config.stages))
        return [
            scenes.draw(
                generator,
                count,
                _between(stage.waypoints, generator),
                _between(stage.uavs, generator),
                self.config.scenes,
            ).to(self.device)
            for stage in self.config.stages
        ]

    def _save(self) -> None:
        if self.workers.rank != 0:
            return
        groups = {
            "policy": dict(self.policy.state_dict()),
            "best": dict(self.best.model.state_dict()),
            "adam": checkpoint.optimiser_tensors(self.optimiser),
        }
        facts = {
            "step": self.step,
            "draws": self.best.draws,
            "config": dataclasses.asdict(self.config),
        }
        checkpoint.save(self.directory / CHECKPOINT, groups, facts)

    def _resume(self) -> None:
        path = self.directory / CHECKPOINT
        groups, facts = checkpoint.load(path)
        same = ("seed", "shape", "baseline")
        now = dataclasses.asdict(self.config)
        for key in same:
            if facts["config"][key] != now[key]:
                raise InputError(
                    f"{path}: trained with {key} = {facts['config'][key]}, asked for {now[key]}; "
                    "choose another directory or delete the checkpoint."
                )
        self.policy.load_state_dict(groups["policy"])
        checkpoint.restore_optimiser(self.optimiser, groups["adam"])
        self.best.restore(groups["best"], facts["draws"])
        self.step = int(facts["step"])

    def _truncate_log(self) -> None:
        """Drop rows of steps that a killed run made after its last checkpoint."""
        path = self.directory / LOG
        if self.workers.rank != 0:
            return
        kept = []
        if path.exists() and self.step:
            with path.open(newline="") as file:
                kept = [row for row in csv.DictReader(file) if int(row["step"]) < self.step]
        draft = path.with_suffix(".tmp")
        with draft.open("w", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS)
            writer.writeheader()
            writer.writerows(kept)
        draft.replace(path)

    def _append_log(self, rows: list[dict[str, float]]) -> None:
        if self.workers.rank != 0:
            return
        with (self.directory / LOG).open("a", newline="") as file:
            csv.DictWriter(file, COLUMNS).writerows(rows)


def _between(limits: tuple[int, int], generator: torch.Generator) -> int:
    return int(torch.randint(limits[0], limits[1] + 1, (1,), generator=generator))
