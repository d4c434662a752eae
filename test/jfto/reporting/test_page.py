"""The report."""

from __future__ import annotations

import re
from pathlib import Path

from jfto.analysis.comparison import FORM_NAMES
from jfto.pipeline.run import Run
from support.html import HtmlChecker


def _page(tiny_run: tuple[Path, Run]) -> str:
    return (tiny_run[0] / "report.html").read_text(encoding="utf-8")


def test_the_report_is_one_well_formed_file_that_loads_nothing(
    tiny_run: tuple[Path, Run],
) -> None:
    """Every element is closed in turn and nothing is fetched from elsewhere."""
    checker = HtmlChecker()
    checker.feed(_page(tiny_run))
    assert checker.amiss == []
    assert checker.open == []
    assert checker.outside == []


def test_the_report_says_what_a_reader_asks_first(tiny_run: tuple[Path, Run]) -> None:
    """Verdict, table beside the paper's, all figures, seed, hash and configuration are in it."""
    _, run = tiny_run
    page = _page(tiny_run)
    assert "Verified" in page
    assert "In brackets: the paper's figures" in page
    assert len(re.findall(r'<img alt="[^"]+" src="data:image/png;base64,', page)) == 5
    assert f"Seed {run.plan.seed}." in page
    assert run.plan.scenario_hash[:16] in page
    assert "ros__parameters" in page


def test_the_scene_has_every_slot_of_every_algorithm(tiny_run: tuple[Path, Run]) -> None:
    """The slider has one position per instant and links for all four algorithms."""
    import json

    _, run = tiny_run
    found = re.search(r"const SCENE = (\{.*?\});\n", _page(tiny_run))
    assert found is not None
    scene = json.loads(found.group(1).replace("<\\/", "</"))
    instants = run.plan.slots.count + 1
    assert len(scene["positions"]) == instants
    assert set(scene["links"]) == {"MTP", "A-LMST", "CPAPO", *FORM_NAMES.values()}
    assert all(len(slots) == instants for slots in scene["links"].values())
    assert [uav["id"] for uav in scene["uavs"]] == [uav.id for uav in run.plan.uavs]
