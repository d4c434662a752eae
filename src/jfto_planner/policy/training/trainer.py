"""The training loop (Algorithm 1): draw, roll out, update, challenge the best model."""

from __future__ import annotations

import csv
import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import torch
from torch import Tensor

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.network.model import Policy
from jfto_planner.policy.problems import Problems, turned
from jfto_planner.policy.training import checkpoint
from jfto_planner.policy.training.baseline import BestModel, greedy_cost, greedy_outcomes
from jfto_planner.policy.training.config import IMITATION, Stage, TrainingConfig
from jfto_planner.policy.training.generator import (
    EVALUATION,
    HELD_OUT,
    TRAINING,
    between,
    draw,
    generator_of,
)
from jfto_planner.policy.training.imitation import Teacher, imitate, ready_shards
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
    "loss",
    "gradient",
    "seconds",
    "challenge",
    "replaced",
    "held_out",
    "held_out_feasible",
)
# Problems that the curve is measured on, the same from the first step to the last.
HELD_OUT_SIZES = ((50, 4), (50, 8))
HELD_OUT_EACH = 48
# Extents of length below which the rollouts of a problem count as equal.
SPREAD_FLOOR = 0.02


@dataclass(frozen=True)
class Progress:
    """What a callback is told after each step."""

    step: int
    total: int
    row: dict[str, float]


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
        self.teacher = Teacher(config, directory)
        self.step = 0
        self.seconds = 0.0
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
        self.best.settle(self.policy)
        return self.best.model

    def _one_step(self) -> dict[str, float]:
        begun_s = time.monotonic()
        number, within = self.config.stage_at(self.step)
        stage = self.config.stages[number]
        self.policy.train(not stage.frozen_norm)
        for group in self.optimiser.param_groups:
            group["lr"] = stage.rate(within)
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.config.bfloat16):
            if stage.method == IMITATION:
                loss, row = imitate(self.policy, *self._lesson(number, within))
            else:
                loss, row = self._explore(stage, within)
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        self.workers.average_gradients(self.policy)
        norm = torch.nn.utils.clip_grad_norm_(self.policy.parameters(), self.config.gradient_clip)
        self.optimiser.step()
        row |= {"step": self.step, "gradient": float(norm)}
        if (self.step + 1) % self.config.evaluate_every == 0:
            self.workers.share_buffers(self.policy)
            row |= self._evaluate()
        self.seconds += time.monotonic() - begun_s
        return row | {"seconds": round(self.seconds, 2)}

    def _lesson(self, number: int, within: int) -> tuple[Problems[Tensor], Tensor]:
        """Problems and routes to imitate: this worker's part of a lesson, each turned at random."""
        stage = self.config.stages[number]
        random = generator_of(self.config.seed, TRAINING, self.step)
        known = ready_shards(stage, within)
        shard = self.teacher.shard(number, int(torch.randint(known, (1,), generator=random)))
        solved = torch.nonzero(shard.solved).squeeze(1)
        lesson = solved[torch.randperm(len(solved), generator=random)]
        own = lesson[: stage.lesson_size(shard.batch.waypoints.shape[1])][
            self.workers.rank :: self.workers.count
        ]
        turns = torch.randint(8, (shard.batch.size,), generator=random)[own]
        lesson_batch = turned(shard.batch.rows(own).numpy(), turns.numpy())
        return lesson_batch.tensors(self.device), shard.routes[own]

    def _explore(self, stage: Stage, within: int) -> tuple[Tensor, dict[str, float]]:
        """Loss of Algorithm 1: REINFORCE with a baseline."""
        batch, generator = self._draw(stage, within)
        outcome = self.policy(batch, stage.rollouts, generator=generator)
        cost = outcome.cost(self.config.miss_penalty, self.config.late_penalty).detach()
        advantage = cost - self._baseline(stage, batch, cost)
        if self.config.normalise:
            # Problem by problem, or the few whose rollouts come late would drown the others.
            spread = advantage.square().mean(1, keepdim=True).sqrt()
            advantage = advantage / (spread + SPREAD_FLOOR)
        loss = (advantage * outcome.log_likelihood).mean()
        clean = (outcome.misses == 0) & (outcome.late == 0)
        return loss, {
            "waypoints": batch.waypoints.shape[1],
            "uavs": batch.start_of.shape[1],
            "length": float(outcome.length.mean()),
            "misses": float(outcome.misses.mean()),
            "late": float(outcome.late.mean()),
            "feasible": float(clean.float().mean()),
        }

    def _draw(self, stage: Stage, within: int) -> tuple[Problems[Tensor], torch.Generator]:
        # All workers draw problems of one size, so that their steps take equally long.
        common = generator_of(self.config.seed, TRAINING, self.step, 63)
        waypoints = between(stage.sizes(within), common)
        uavs = between(stage.uavs, common)
        own = generator_of(self.config.seed, TRAINING, self.step, self.workers.rank)
        count = stage.problems(waypoints)
        batch = draw(own, count, waypoints, uavs, self.config.scenes)
        sampling = own
        if self.device.type != "cpu":
            sampling = torch.Generator(self.device).manual_seed(own.initial_seed() + 1)
        return batch.tensors(self.device), sampling

    def _baseline(self, stage: Stage, batch: Problems[Tensor], cost: Tensor) -> Tensor:
        if stage.baseline == "shared":
            return cost.mean(1, keepdim=True)
        return greedy_cost(self.best.model, [batch], self.config).to(cost)[:, None]

    def _evaluate(self) -> dict[str, float]:
        """Challenge the best model, and measure the policy on the problems held out."""
        challenge, replaced = self.best.challenge(self.policy)
        outcomes = greedy_outcomes(self.policy, self._held_out)
        lengths = torch.cat([outcome.length for outcome in outcomes])
        clean = [(outcome.misses == 0) & (outcome.late == 0) for outcome in outcomes]
        return {
            "challenge": challenge,
            "replaced": replaced,
            "held_out": float(lengths.mean()),
            "held_out_feasible": float(torch.cat(clean).float().mean()),
        }

    @cached_property
    def _held_out(self) -> list[Problems[Tensor]]:
        return [
            draw(
                generator_of(self.config.seed, HELD_OUT, number),
                HELD_OUT_EACH,
                waypoints,
                uavs,
                self.config.scenes,
            ).tensors(self.device)
            for number, (waypoints, uavs) in enumerate(HELD_OUT_SIZES)
        ]

    def _evaluation_problems(self, number: int) -> list[Problems[Tensor]]:
        """Problems that the best model is judged by: the sizes of every stage in equal parts."""
        generator = generator_of(self.config.seed, EVALUATION, number)
        count = max(2, self.config.evaluation_instances // len(self.config.stages))
        return [
            draw(
                generator,
                count,
                between(stage.waypoints, generator),
                between(stage.uavs, generator),
                self.config.scenes,
            ).tensors(self.device)
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
            "seconds": self.seconds,
            "draws": self.best.draws,
            "config": dataclasses.asdict(self.config),
        }
        checkpoint.save(self.directory / CHECKPOINT, groups, facts)

    def _resume(self) -> None:
        path = self.directory / CHECKPOINT
        groups, facts = checkpoint.load(path)
        same = ("seed", "shape")
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
        self.seconds = float(facts["seconds"])

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
