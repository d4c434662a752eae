"""jfto train, with a policy and scenes as small as they can be."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
import torch
import yaml

from jfto.cli import main
from jfto_planner.policy.weights import NAME, load_weights

STAGE = {"steps": 1, "waypoints": [5, 7], "uavs": [3, 4], "instances": 4, "rollouts": 2}
CONFIG = {
    "seed": 4,
    "stages": [STAGE],
    "evaluate_every": 1,
    "evaluation_instances": 4,
    "checkpoint_every": 1,
    "shape": {"width": 16, "heads": 4, "layers": 1, "hidden": 16},
}


def _train(config: dict[str, object], directory: Path, *options: str) -> int:
    file = directory / "config.yaml"
    file.write_text(yaml.safe_dump(config))
    return main(["train", str(file), "-o", str(directory), "--threads", "1", *options])


def _curve(directory: Path) -> list[dict[str, str]]:
    with (directory / "log.csv").open(newline="") as file:
        return [{k: row[k] for k in row if k != "seconds"} for row in csv.DictReader(file)]


@pytest.mark.slow
def test_a_run_that_was_stopped_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One step writes weights that can be loaded; asked for one more, it keeps the first."""
    assert _train(CONFIG, tmp_path, "--device", "cpu") == 0
    assert str(tmp_path / NAME) in capsys.readouterr().out
    load_weights(tmp_path / NAME)
    first = _curve(tmp_path)
    assert [row["step"] for row in first] == ["0"]
    assert _train({**CONFIG, "stages": [{**STAGE, "steps": 2}]}, tmp_path, "--device", "cpu") == 0
    both = _curve(tmp_path)
    assert [row["step"] for row in both] == ["0", "1"]
    assert both[:1] == first


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("- 1\n", "holds no keys"),
        ("seed: [\n", "is not YAML"),
        ("seed: 1\nstagez: []\n", "stagez"),
    ],
)
def test_a_wrong_configuration_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, words: str
) -> None:
    """Status 2, the file and what is wrong with it, and nothing is written."""
    file = tmp_path / "config.yaml"
    file.write_text(text)
    assert main(["train", str(file), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert str(file) in said
    assert words in said
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a GPU")
def test_a_gpu_that_is_not_there_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Asked for a GPU, training doesn't silently take the processor."""
    assert _train(CONFIG, tmp_path, "--device", "cuda") == 2
    assert "torch sees no GPU" in capsys.readouterr().err
