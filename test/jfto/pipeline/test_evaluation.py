"""Several plans compared at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from jfto.console.progress import Progress
from jfto.pipeline.evaluation import Evaluated, write_evaluation
from jfto.pipeline.run import Run
from jfto_msgs_py.scenario.mission import EvaluationPart


@pytest.mark.slow
def test_plans_of_one_scene_have_folders_of_their_own(
    tiny_run: tuple[Path, Run], tmp_path: Path
) -> None:
    """None is written over by the next; without terrain it is said that maps are left out."""
    run, warned = tiny_run[1], []
    assert run.comparison is not None

    class Told(Progress):
        def warn(self, text: str) -> None:
            warned.append(text)

    one = Evaluated("small", run.plan, run.comparison, None, EvaluationPart())
    write_evaluation([one, one], tmp_path, Told())
    lines = (tmp_path / "comparison.csv").read_text().splitlines()
    assert len(lines) == 1 + 2 * len(run.comparison.results)
    for folder in ("small", "small-2"):
        names = {path.name for path in (tmp_path / folder).iterdir()}
        assert names >= {"slots.csv", "throughput.png", "degree_energy.pdf"}
        assert "routes.png" not in names
    assert len(warned) == 2
    assert "maps left out" in warned[0]
