"""What a second run in the same directory makes again, and what it keeps."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from jfto.console.progress import Progress
from jfto.pipeline.directory import forget_dry_run, require_no_flight
from jfto.pipeline.products import MADE_NAME, Products, digest
from jfto.pipeline.run import Pipeline, Run
from jfto.planning.scenario_file import load_scenario
from support.runs import run_all

ALL = {"routes", "figures", "report"}


class Told(Progress):
    """Remembers which stages kept their results, and which worked."""

    def __init__(self) -> None:
        self.kept: set[str] = set()
        self.worked: set[str] = set()

    def end(self, stage: str, result: str, detail: str, *, good: bool = True) -> None:
        """One of both."""
        (self.kept if detail.startswith("kept") else self.worked).add(stage)


@pytest.fixture
def directory(tiny_run: tuple[Path, Run], tmp_path: Path) -> Path:
    """A copy of the tiny run."""
    return Path(shutil.copytree(tiny_run[0], tmp_path / "run"))


def _again(directory: Path, scenario: Path, *overrides: str) -> tuple[Run, Told]:
    told = Told()
    return run_all(load_scenario(scenario, overrides), directory, told), told


def test_nothing_is_made_again_where_nothing_changed(
    tiny: Path, tiny_run: tuple[Path, Run], directory: Path
) -> None:
    """Plan, figures and page are kept, and so is every byte; the comparison is computed again."""
    before = {path: path.read_bytes() for path in directory.rglob("*.*")}
    run, told = _again(directory, tiny)
    assert told.kept == ALL
    assert told.worked == {"topology", "power", "compare"}
    assert {path: path.read_bytes() for path in directory.rglob("*.*")} == before
    first = tiny_run[1]
    assert run.comparison is not None
    assert first.comparison is not None
    assert run.plan.routes == first.plan.routes
    assert run.plan.clean
    assert np.array_equal(run.comparison.ours.power_w, first.comparison.ours.power_w)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("override", "kept"), [("evaluation.slot_shown=3", {"routes"}), ("network.delta=1", set())]
)
def test_what_depends_on_a_changed_key_is_made_again(
    tiny: Path, directory: Path, override: str, kept: set[str]
) -> None:
    """A plan doesn't depend on what is shown of it; everything depends on the plan."""
    _, told = _again(directory, tiny, override)
    assert told.kept == kept
    assert told.worked >= ALL - kept


@pytest.mark.slow
def test_a_file_that_somebody_changed_is_made_again(tiny: Path, directory: Path) -> None:
    """And a lost one; what lies beside it is kept."""
    page = (directory / "report.html").read_bytes()
    (directory / "report.html").write_text("scribbled over")
    (directory / "figures" / "routes.pdf").unlink()
    _, told = _again(directory, tiny)
    assert told.kept == {"routes"}
    assert (directory / "report.html").read_bytes() == page
    assert (directory / "figures" / "routes.pdf").exists()


def test_waypoints_in_a_file_are_an_input(tiny: Path, tmp_path: Path) -> None:
    """A file that the scenario names makes the plan anew when its contents change."""
    file = tmp_path / "waypoints.csv"
    rows = [f"{i},36.6255{i},-84.265{i},900\n" for i in range(1, 9)]
    file.write_text("id,lat,lon,alt\n" + "".join(rows))
    loaded = load_scenario(tiny, ["waypoints.source=file", f"waypoints.file={file}"])

    def stages() -> Told:
        told = Told()
        assert Pipeline(loaded, tmp_path / "run", told).plan().plan.clean
        return told

    assert stages().worked == {"coverage", "routes", "way home"}
    assert stages().kept == {"routes"}
    file.write_text("id,lat,lon,alt\n" + "".join(rows[:-1]))
    assert stages().worked == {"coverage", "routes", "way home"}


def test_a_damaged_memory_makes_everything_anew(tiny: Path, directory: Path) -> None:
    """Whatever stands in made.json, nothing fails and nothing wrong is kept."""
    for text in ("", "[]", '{"products": {"plan": 1}}', '{"products": {}, "more": 1}'):
        (directory / MADE_NAME).write_text(text)
        assert Products(directory).kept("plan", "x") == ()
    told = Told()
    Pipeline(load_scenario(tiny), directory, told).plan()
    assert not told.kept
    assert list(json.loads((directory / MADE_NAME).read_text())["products"]) == ["plan"]


def test_digests_tell_lists_of_inputs_apart(tmp_path: Path) -> None:
    """Neither a moved boundary nor a file that comes or goes looks alike."""
    file = tmp_path / "file"
    found = {digest(["ab", "c"]), digest(["a", "bc"]), digest(["abc"]), digest([file])}
    file.write_text("abc")
    assert len({*found, digest([file])}) == 5


def test_a_dry_run_leaves_nothing_that_a_flight_would_go_on_with(tmp_path: Path) -> None:
    """Lift-off, energy and flight of nobody are forgotten; a bag is a record and stays."""
    for name in ("lift_off.json", "energy.json", "flight_state.json", "plan.json"):
        (tmp_path / name).touch()
    forget_dry_run(tmp_path)
    require_no_flight(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]
