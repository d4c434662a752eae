"""Settings of a training run."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import FileKind, read_text, record_of_values
from jfto_planner.policy.compiled_policy import PolicyShape
from jfto_planner.policy.training.generator import SceneRanges

KIND = FileKind("training", "config/train_rl_tp.yaml is an example.", sparse=True)
BASELINES = ("greedy_rollout", "shared")
IMITATION, REINFORCE = METHODS = ("imitation", "reinforce")


@dataclass(frozen=True)
class Stage:
    """One stretch of the curriculum: sizes drawn uniformly from closed ranges.

    Every `large_every`-th step draws its waypoints from `large` instead, and so many fewer
    problems that it takes no more memory. The learning rate falls from `learning_rate` to
    `final_rate` along half a cosine. An "imitation" stage maximises the likelihood of the search's
    routes on `shards` sets of problems, for each of which the search tries `moves` moves; a step
    takes `lesson` problems of one set, or the whole set if that is 0. The `baseline` of REINFORCE
    is "greedy_rollout", the best model's greedy rollout, or "shared", the mean of the rollouts of
    one problem, as in POMO. With `frozen_norm` batch normalisation keeps the statistics that it has
    and uses them as in inference: a step's problems are of one size, so its own differ from them.
    """

    steps: int
    waypoints: tuple[int, int]
    uavs: tuple[int, int]
    instances: int  # problems per step
    rollouts: int = 1  # of each problem
    learning_rate: float = 3e-4
    final_rate: float | None = None
    method: str = REINFORCE
    large: tuple[int, int] = (100, 140)
    large_every: int = 0
    shards: int = 0
    moves: int = 20_000
    lesson: int = 0
    baseline: str = "greedy_rollout"
    frozen_norm: bool = False

    def sizes(self, number: int) -> tuple[int, int]:
        """Range of waypoints of the stage's step or shard of a number."""
        return self.large if self.is_large(number) else self.waypoints

    def is_large(self, number: int) -> bool:
        """Whether a step or shard is one of the large ones."""
        return self.large_every > 0 and number % self.large_every == self.large_every - 1

    def problems(self, waypoints: int) -> int:
        """Problems of a step with so many waypoints."""
        return max(2, self.instances * self.waypoints[1] // max(waypoints, self.waypoints[1]))

    def lesson_size(self, waypoints: int) -> int:
        """Problems of a step of imitation with so many waypoints; large ones, whose choices and
        options both grow, so many fewer that the step takes no more time.
        """
        if not self.lesson:
            return self.instances
        growth = max(waypoints / self.waypoints[1], 1)
        return max(2, int(self.lesson / growth**2))

    def rate(self, step: int) -> float:
        """Learning rate of the stage's step of a number."""
        if self.final_rate is None:
            return self.learning_rate
        fall = 0.5 * (1 + math.cos(math.pi * step / self.steps))
        return self.final_rate + (self.learning_rate - self.final_rate) * fall


@dataclass(frozen=True)
class TrainingConfig:
    """Everything that decides the outcome of a run, given the machine's arithmetic.

    The best model is replaced when a one-sided paired t-test at `significance` says that the
    policy is better, and is what is kept in the end. `bfloat16` computes products in half
    precision, on CUDA and on CPUs that have AMX. `normalise` divides the advantages of each
    problem's rollouts by their root mean square.
    """

    seed: int
    stages: tuple[Stage, ...]
    significance: float = 0.05
    miss_penalty: float = 0.1
    late_penalty: float = 2.0
    gradient_clip: float = 1.0
    evaluate_every: int = 100
    evaluation_instances: int = 128
    checkpoint_every: int = 25
    bfloat16: bool = False
    normalise: bool = False
    shape: PolicyShape = field(default_factory=PolicyShape)
    scenes: SceneRanges = field(default_factory=SceneRanges)

    def __post_init__(self) -> None:
        if not self.stages:
            raise InputError("stages is empty, give at least one.")
        if not 0 < self.significance < 1:
            raise InputError(f"significance is {self.significance}, must lie between 0 and 1.")
        for number, stage in enumerate(self.stages):
            _check(stage, f"stages[{number}]")

    @property
    def total_steps(self) -> int:
        """Optimiser steps of all stages."""
        return sum(stage.steps for stage in self.stages)

    def stage_at(self, step: int) -> tuple[int, int]:
        """Number of the stage that a step belongs to, and the step's number within it."""
        for number, stage in enumerate(self.stages):
            if step < stage.steps:
                return number, step
            step -= stage.steps
        raise ValueError("beyond the last stage")


def _check(stage: Stage, name: str) -> None:
    if stage.method not in METHODS:
        raise InputError(f"{name}.method is {stage.method!r}, must be one of {METHODS}.")
    if stage.method == IMITATION and stage.shards < 1:
        raise InputError(f"{name}.shards is {stage.shards}; imitation needs at least 1.")
    if not 0 <= stage.lesson <= stage.instances:
        raise InputError(f"{name}.lesson is {stage.lesson}, must be 0 to {stage.instances}.")
    if stage.baseline not in BASELINES:
        raise InputError(f"{name}.baseline is {stage.baseline!r}, must be one of {BASELINES}.")
    if stage.method == REINFORCE and stage.rollouts < 2 and stage.baseline == "shared":
        raise InputError(f"{name}.rollouts is {stage.rollouts}; a shared baseline needs 2.")


def read_training(path: Path) -> TrainingConfig:
    """Settings of a training run in a YAML file; raises InputError naming file, key and reason."""
    text = read_text(path, KIND.error, KIND.what, KIND.size_limit)
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise KIND.fault(f"{path}: is not YAML: {error}.") from None
    if not isinstance(values, dict):
        raise KIND.fault(f"{path}: holds no keys.")
    return from_dict(values, str(path))


def from_dict(values: dict[str, Any], name: str = "training") -> TrainingConfig:
    """Configuration from plain values, as read from the YAML file of a name.

    Raises InputError naming an unknown, missing or ill-typed key.
    """
    return record_of_values(values, name, TrainingConfig, KIND)
