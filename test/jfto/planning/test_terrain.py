"""What a plan and its report say of the terrain."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import rasterio
from affine import Affine

from jfto.cli import main
from jfto.pipeline.directory import make_run_directory
from jfto.planning.scenario_file import load_scenario
from jfto.planning.terrain import terrain_files
from support.html import HtmlChecker
from support.runs import run_all

GEOID_M = 51.9
PLACE = "terrain.center_deg=[46.2, 7.6]"


@pytest.fixture(scope="module")
def silent(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Level ground at 1500 m that does not say above what."""
    path = tmp_path_factory.mktemp("terrain") / "silent.tif"
    options = {"driver": "GTiff", "count": 1, "dtype": "float32", "height": 240, "width": 240}
    options["transform"] = Affine(1 / 3600, 0, 7.6 - 1 / 30, 0, -1 / 3600, 46.2 + 1 / 30)
    with rasterio.open(path, "w", crs="EPSG:4326", **options) as dataset:
        dataset.write(np.full((240, 240), 1500, dtype=np.float32), 1)
    return path


def planned(
    tiny: Path, path: Path, capsys: pytest.CaptureFixture[str], *sets: str
) -> tuple[str, dict[str, object]]:
    """What `jfto plan` says in one line, and the origin of its plan."""
    given = [argument for one in sets for argument in ("--set", one)]
    assert main(["plan", str(tiny), *given, "-o", str(path)]) == 0
    captured = capsys.readouterr()
    origin = json.loads(path.read_text(encoding="utf-8"))["origin"]
    return " ".join((captured.out + captured.err).split()), origin


def test_a_plan_names_a_datum_that_is_not_declared(
    tiny: Path, silent: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A line names the file and the key; the plan's origin says it to programs."""
    sets = (f"terrain.source={silent}", PLACE)
    said, origin = planned(tiny, tmp_path / "plan.json", capsys, *sets)
    assert "silent.tif does not say what its heights are measured from" in said
    assert "declare terrain.vertical_datum" in said
    assert "names no vertical datum" in str(origin["datum"])
    assert origin["alt_m"] == pytest.approx(1500.0, abs=0.01)


def test_a_plan_says_how_heights_came_to_sea_level(
    tiny: Path, silent: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Heights above the ellipsoid are lowered by the geoid, by how much is said."""
    sets = (f"terrain.source={silent}", PLACE, "terrain.vertical_datum=ellipsoid")
    said, origin = planned(tiny, tmp_path / "plan.json", capsys, *sets)
    assert "brought to sea level by the geoid EGM96" in said
    assert origin["alt_m"] == pytest.approx(1500 - GEOID_M, abs=0.2)
    assert str(origin["datum"]).startswith("mean sea level by the geoid EGM96")


def test_the_report_names_it_too(tiny: Path, silent: Path, tmp_path: Path) -> None:
    """Above the verdict, and the page stays well formed."""
    loaded = load_scenario(tiny, [f"terrain.source={silent}", PLACE])
    directory = make_run_directory(tmp_path / "run")
    run_all(loaded, directory)
    page = (directory / "report.html").read_text(encoding="utf-8")
    checker = HtmlChecker()
    checker.feed(page)
    assert checker.amiss == []
    assert "<strong>Terrain:</strong>" in page
    assert page.index("does not say what its heights are measured from") < page.index("Verified")


def test_the_built_in_tile_needs_no_word(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What is known is not warned of."""
    said, origin = planned(tiny, tmp_path / "plan.json", capsys)
    assert "does not say" not in said
    assert origin["datum"] == "mean sea level"


def test_files_of_folders_and_mosaics_are_known(tiny: Path, tmp_path: Path) -> None:
    """A run is made anew when any of them has changed."""
    tiles = tmp_path / "tiles"
    tiles.mkdir()
    for name in ("a.tif", "b.tif"):
        (tiles / name).write_bytes(b"x")
    mosaic = tmp_path / "all.vrt"
    mosaic.write_text('<SourceFilename relativeToVRT="1">tiles/a.tif</SourceFilename>')
    sets = [f"terrain.source={tiles}", f"terrain.surface={mosaic}"]
    expected = [tiles / "a.tif", tiles / "b.tif", mosaic, tiles / "a.tif"]
    assert terrain_files(load_scenario(tiny, sets)) == expected
    assert terrain_files(load_scenario(tiny)) == []
