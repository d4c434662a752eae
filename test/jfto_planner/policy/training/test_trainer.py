"""The training loop."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import torch

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.compiled_policy import PolicyShape
from jfto_planner.policy.training.baseline import significantly_better
from jfto_planner.policy.training.config import Stage, TrainingConfig, from_dict
from jfto_planner.policy.training.imitation import Teacher
from jfto_planner.policy.training.trainer import LOG, Trainer

CONFIG = TrainingConfig(
    seed=4,
    stages=(
        Stage(
            2,
            (5, 7),
            (3, 4),
            instances=4,
            method="imitation",
            shards=2,
            lesson=3,
            moves=300,
            large=(8, 9),
            large_every=2,
        ),
        Stage(4, (5, 7), (3, 4), instances=4, rollouts=4, learning_rate=1e-3, final_rate=1e-4),
    ),
    evaluate_every=2,
    evaluation_instances=8,
    checkpoint_every=2,
    shape=PolicyShape(width=16, heads=4, layers=1, hidden=16),
)


STAGE = {"steps": 1, "waypoints": [5, 7], "uavs": [3, 4], "instances": 2}


class KilledError(Exception):
    """Stands for kill -9 between two checkpoints."""


def _log(directory: Path) -> list[dict[str, str]]:
    with (directory / LOG).open(newline="") as file:
        return list(csv.DictReader(file))


def _curve(directory: Path) -> list[dict[str, str]]:
    """The log without the clock."""
    return [{key: row[key] for key in row if key != "seconds"} for row in _log(directory)]


@pytest.mark.slow
def test_a_killed_run_resumes_with_the_same_curve(tmp_path) -> None:
    """Killed after step 5 and resumed from the checkpoint at 4, a run logs and learns the same."""
    whole = Trainer(CONFIG, tmp_path / "whole")
    whole.run()

    def kill(progress) -> None:
        if progress.step == 5:
            raise KilledError

    with pytest.raises(KilledError):
        Trainer(CONFIG, tmp_path / "killed").run(kill)
    resumed = Trainer(CONFIG, tmp_path / "killed")
    assert resumed.step == 4
    resumed.run()
    assert _curve(tmp_path / "killed") == _curve(tmp_path / "whole")
    for name, value in whole.policy.state_dict().items():
        assert torch.equal(value, resumed.policy.state_dict()[name]), name


@pytest.mark.slow
def test_both_baselines_train(tmp_path) -> None:
    """The shared baseline moves the weights too."""
    stages = tuple(replace(stage, baseline="shared") for stage in CONFIG.stages)
    trainer = Trainer(replace(CONFIG, stages=stages), tmp_path)
    before = trainer.policy.decoder.stop_bias.item()
    trainer.run()
    assert trainer.policy.decoder.stop_bias.item() != before


@pytest.mark.slow
def test_imitation_makes_the_routes_likelier(tmp_path) -> None:
    """Steps on one shard raise the likelihood of the search's routes there."""
    stage = replace(CONFIG.stages[0], steps=40, shards=1, instances=6, learning_rate=3e-3)
    Trainer(replace(CONFIG, stages=(stage,), evaluate_every=100), tmp_path).run()
    losses = [float(row["loss"]) for row in _log(tmp_path)]
    assert sum(losses[-10:]) < 0.8 * sum(losses[:10])


@pytest.mark.slow
def test_a_frozen_norm_keeps_its_statistics(tmp_path) -> None:
    """With `frozen_norm` the weights move and the running statistics do not; without, both do."""
    for frozen in (False, True):
        stages = tuple(replace(stage, frozen_norm=frozen) for stage in CONFIG.stages)
        trainer = Trainer(replace(CONFIG, stages=stages), tmp_path / str(frozen))
        norm = trainer.policy.encoder.layers[0].norm_attention.norm
        mean, weight = norm.running_mean.clone(), norm.weight.detach().clone()
        trainer.run()
        assert torch.equal(norm.running_mean, mean) is frozen
        assert not torch.equal(norm.weight, weight)


def test_a_shard_is_solved_once(tmp_path) -> None:
    """The second time a shard comes from the disk, with sound routes for its problems."""
    first = Teacher(CONFIG, tmp_path).shard(0, 0)
    (file,) = tmp_path.glob("teacher/*")
    written = file.stat().st_mtime_ns
    again = Teacher(CONFIG, tmp_path).shard(0, 0)
    assert file.stat().st_mtime_ns == written
    assert torch.equal(first.routes, again.routes)
    waypoints = first.batch.waypoints.shape[1]
    assert first.solved.any()
    for routes in first.routes[first.solved]:
        assert sorted(routes[routes < waypoints].tolist()) == list(range(waypoints))


def test_the_learning_rate_falls_along_a_cosine() -> None:
    """It starts at learning_rate, is halfway in the middle, and nears final_rate."""
    stage = Stage(100, (5, 7), (3, 4), instances=4, learning_rate=1e-3, final_rate=1e-4)
    assert stage.rate(0) == 1e-3
    assert stage.rate(50) == pytest.approx(5.5e-4)
    assert stage.rate(99) == pytest.approx(1e-4, rel=0.01)


def test_large_steps_take_fewer_problems() -> None:
    """Every third step is large and has so many fewer problems that the nodes stay as many."""
    stage = Stage(9, (20, 60), (3, 4), instances=12, large=(100, 140), large_every=3)
    assert [stage.sizes(number) for number in range(3)] == [(20, 60), (20, 60), (100, 140)]
    assert stage.problems(30) == 12
    assert stage.problems(120) == 6


def test_a_lesson_is_part_of_a_shard_and_shrinks_with_the_square_of_the_size() -> None:
    """48 problems up to 60 waypoints, a quarter at 120; without a lesson the whole shard."""
    stage = Stage(9, (20, 60), (3, 4), instances=128, method="imitation", shards=1, lesson=48)
    assert [stage.lesson_size(waypoints) for waypoints in (20, 60, 120, 600)] == [48, 48, 12, 2]
    assert replace(stage, lesson=0).lesson_size(120) == 128


def test_a_lesson_larger_than_its_shard_is_refused() -> None:
    """A shard of 8 problems cannot give 9."""
    with pytest.raises(InputError, match=r"lesson is 9.*8"):
        replace(CONFIG, stages=(replace(CONFIG.stages[0], instances=8, lesson=9),))


def test_the_t_test_wants_evidence() -> None:
    """A better mean by chance is not enough; a consistent gain is; a loss never is."""
    generator = torch.Generator().manual_seed(0)
    old = torch.rand(200, generator=generator)
    assert significantly_better(old - 0.01, old, 0.05)
    assert not significantly_better(old + 0.01, old, 0.05)
    noisy = old + 10 * (torch.rand(200, generator=generator) - 0.5)
    assert not significantly_better(noisy - noisy.mean() + old.mean() - 1e-3, old, 0.05)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"seed": 1}, "lacks stages"),
        ({"seed": 1, "stages": []}, "at least one"),
        ({"seed": 1, "stages": [{"steps": 1}]}, r"stages\[0\] lacks waypoints"),
        ({"seed": 1, "stages": 3}, "must be a list"),
        ({"seed": 1, "stages": [STAGE | {"method": "guess"}]}, r"stages\[0\].method is 'guess'"),
        ({"seed": 1, "stages": [STAGE | {"baseline": "none"}]}, r"stages\[0\].baseline is"),
        ({"seed": 1, "stages": [STAGE | {"method": "imitation"}]}, "needs at least 1"),
        ({"seed": 1, "stages": [7]}, r"stages\[0\] is 7, must be an object"),
        ({"sead": 1, "stages": []}, "unknown key sead. Did you mean seed"),
    ],
)
def test_bad_configurations_name_the_key(values, message) -> None:
    """Unknown, missing and ill-typed keys are named."""
    with pytest.raises(InputError, match=message):
        from_dict(values)


@pytest.mark.slow
def test_a_checkpoint_of_another_run_is_refused(tmp_path) -> None:
    """Resuming with another seed would mix two runs."""
    Trainer(CONFIG, tmp_path).run()
    with pytest.raises(InputError, match="trained with seed = 4"):
        Trainer(replace(CONFIG, seed=5), tmp_path)


WORKER = """
import sys
from pathlib import Path
sys.path[:0] = sys.argv[1].split(":")
import torch
from test_trainer import CONFIG
from jfto_planner.policy.training.trainer import Trainer
trainer = Trainer(CONFIG, Path(sys.argv[2]) / "run")
trainer.run()
name = f"rank{trainer.workers.rank}.pt"
vector = torch.nn.utils.parameters_to_vector(trainer.policy.parameters())
Path(sys.argv[2], name).write_text(repr(vector.double().sum().item()))
"""


@pytest.mark.slow
def test_two_workers_stay_in_step(tmp_path) -> None:
    """Two gloo processes average their gradients: their weights stay equal to each other."""
    script = tmp_path / "worker.py"
    script.write_text(WORKER)
    here = Path(__file__).parent
    paths = ":".join([str(here), str(here.parents[3] / "src")])
    command = [sys.executable, "-m", "torch.distributed.run", "--nproc_per_node=2"]
    command += ["--standalone", str(script), paths, str(tmp_path)]
    environment = os.environ | {"OMP_NUM_THREADS": "1", "GLOO_SOCKET_IFNAME": "lo"}
    done = subprocess.run(
        command, env=environment, check=False, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr[-2000:]
    sums = [(tmp_path / f"rank{rank}.pt").read_text() for rank in (0, 1)]
    assert sums[0] == sums[1]
