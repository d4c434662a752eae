"""Settings of a training run."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.generator import SceneRanges
from jfto_planner.policy.model import PolicyShape

BASELINES = ("greedy_rollout", "shared")


@dataclass(frozen=True)
class Stage:
    """One stretch of the curriculum: sizes drawn uniformly from closed ranges."""

    steps: int
    waypoints: tuple[int, int]
    uavs: tuple[int, int]
    instances: int  # problems per step
    rollouts: int  # of each problem
    learning_rate: float = 3e-4


@dataclass(frozen=True)
class TrainingConfig:
    """Everything that decides the outcome of a run, given the machine's arithmetic.

    `baseline` is "greedy_rollout" (the best model's greedy rollout, replaced when a one-sided
    paired t-test at `significance` says that the policy is better) or "shared" (the mean of the
    rollouts of one problem, as in POMO; the t-test then only chooses the model that is kept).
    `multi_start` forces the rollouts of a problem to begin at different waypoints.
    """

    seed: int
    stages: tuple[Stage, ...]
    baseline: str = "greedy_rollout"
    multi_start: bool = False
    significance: float = 0.05
    miss_penalty: float = 0.1
    late_penalty: float = 2.0
    gradient_clip: float = 1.0
    evaluate_every: int = 100
    evaluation_instances: int = 128
    checkpoint_every: int = 25
    shape: PolicyShape = field(default_factory=PolicyShape)
    scenes: SceneRanges = field(default_factory=SceneRanges)

    def __post_init__(self) -> None:
        if self.baseline not in BASELINES:
            raise InputError(f"baseline is {self.baseline!r}, must be one of {BASELINES}.")
        if not self.stages:
            raise InputError("stages is empty, give at least one.")
        if not 0 < self.significance < 1:
            raise InputError(f"significance is {self.significance}, must lie between 0 and 1.")
        for number, stage in enumerate(self.stages):
            if stage.rollouts < 2 and self.baseline == "shared":
                raise InputError(
                    f"stages[{number}].rollouts is {stage.rollouts}; a shared baseline needs 2."
                )

    @property
    def total_steps(self) -> int:
        """Optimiser steps of all stages."""
        return sum(stage.steps for stage in self.stages)

    def stage_at(self, step: int) -> Stage:
        """Stage that a step belongs to."""
        for stage in self.stages:
            if step < stage.steps:
                return stage
            step -= stage.steps
        return self.stages[-1]


def from_dict(values: dict[str, Any]) -> TrainingConfig:
    """Configuration from plain values, as read from a YAML file.

    Raises InputError naming an unknown, missing or ill-typed key.
    """
    known = dict(values)
    parts: dict[str, Any] = {}
    if "stages" in known:
        stages = known.pop("stages")
        if not isinstance(stages, list):
            raise InputError("stages must be a list of stages.")
        parts["stages"] = tuple(
            _build(Stage, stage, f"stages[{number}]") for number, stage in enumerate(stages)
        )
    if "shape" in known:
        parts["shape"] = _build(PolicyShape, known.pop("shape"), "shape")
    if "scenes" in known:
        parts["scenes"] = _build(SceneRanges, known.pop("scenes"), "scenes")
    return _build(TrainingConfig, known | parts, "training")


def _build(kind: type, values: Any, name: str) -> Any:
    if not isinstance(values, dict):
        raise InputError(f"{name} must be a map of keys, is {values!r}.")
    fields = {item.name: item for item in dataclasses.fields(kind)}
    for key in values:
        if key not in fields:
            raise InputError(f"{name}.{key} is unknown; known keys are {', '.join(fields)}.")
    for key, item in fields.items():
        missing = item.default is dataclasses.MISSING
        if missing and item.default_factory is dataclasses.MISSING and key not in values:
            raise InputError(f"{name}.{key} is missing.")
    pairs = {
        key: tuple(value) if isinstance(value, list) else value for key, value in values.items()
    }
    return kind(**pairs)
