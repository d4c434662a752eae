"""The report of a run that was flown, rebuilt from scenario, plan and bag."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from jfto.console.progress import Progress
from jfto.pipeline.directory import flight_bags
from jfto.pipeline.run import Run, rebuild
from jfto_mavlink.preflight.page import (
    AMBER,
    GREEN,
    RED,
    Finding,
    Preflight,
    VehiclePage,
    write_page,
)
from jfto_msgs_py.records.event import WARN, Event
from support.fleets import START_NS
from support.flights import Flaws, FlightBag, tracks_of
from support.html import HtmlChecker

DOCUMENT = Path(__file__).parents[3] / "docs/reference/flight.md"
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def flown_run(
    tiny_run: tuple[Path, Run], tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Run]:
    """Scenario and plan of the tiny run with a bag of its flight, in which uav4 is lost."""
    source, run = tiny_run
    assert run.comparison is not None
    directory = tmp_path_factory.mktemp("flown")
    for name in ("scenario.yaml", "plan.json"):
        shutil.copy(source / name, directory)
    bag = FlightBag(directory / "bag")
    bag.lift_off()
    bag.poses(tracks_of(run.plan, Flaws(gone_s={"uav4": 70.0})))
    bag.powers(run.plan, run.comparison.ours.power_w)
    text = "uav4 <silent> since 70 s: its neighbours keep the link"
    bag.event(Event(WARN, "link", "uav4", text, START_NS + 72 * 10**9, "mavlink_bridge"))
    bag.close()
    return directory, rebuild(directory)


def test_the_page_tells_of_the_flight(flown_run: tuple[Path, Run]) -> None:
    """Verdict, five more figures, the lost UAV with its cause, and still one well-formed file."""
    page = (flown_run[0] / "report.html").read_text(encoding="utf-8")
    checker = HtmlChecker()
    checker.feed(page)
    assert (checker.amiss, checker.open, checker.outside) == ([], [], [])
    assert "Not all as planned" in page
    assert len(re.findall(r'<img alt="[^"]+" src="data:image/png;base64,', page)) == 10
    assert "uav4 was not there" in page
    assert "uav4 &lt;silent&gt; since 70 s: its neighbours keep the link (72 s)" in page


def test_the_view_in_space_has_the_flight(flown_run: tuple[Path, Run]) -> None:
    """Tracks and links as flown can be picked; a UAV that is gone has no place."""
    page = (flown_run[0] / "report.html").read_text(encoding="utf-8")
    found = re.search(r"const SCENE = (\{.*?\});\n", page)
    assert found is not None
    flown = json.loads(found.group(1).replace("<\\/", "</"))["flown"]
    assert len(flown["tracks"]) == 4
    assert len(flown["positions"]) == len(flown["links"]) == 11
    assert flown["positions"][10][3] == [None, None, None]
    assert None not in flown["positions"][10][0]
    assert "<option selected>C-TOP as flown</option>" in page


def test_flight_json_is_as_documented(flown_run: tuple[Path, Run]) -> None:
    """docs/reference/flight.md names every key that is written; the facts are the flight's."""
    facts = json.loads((flown_run[0] / "flight.json").read_text(encoding="utf-8"))

    def keys(value: object) -> set[str]:
        if isinstance(value, dict):
            return set(value).union(*(keys(one) for one in value.values()))
        return set().union(*(keys(one) for one in value)) if isinstance(value, list) else set()

    documented = set(re.findall(r"`(\w+)`", DOCUMENT.read_text(encoding="utf-8")))
    assert keys(facts) - documented == set()
    assert (facts["format"], facts["version"]) == ("jfto-flight", 1)
    assert facts["waypoints"]["visited"] == 11
    assert {one["uav"]: one["how"] for one in facts["endings"]}["uav4"] == "lost"
    assert [one["kind"] for one in facts["certificate"]["exceptions"]] == ["lost"]


def test_a_rebuilt_report_has_the_same_facts(flown_run: tuple[Path, Run]) -> None:
    """flight.json comes out of the bag again with the same bytes."""
    directory, _ = flown_run
    before = (directory / "flight.json").read_bytes()
    (directory / "flight.json").unlink()
    assert rebuild(directory).flight is not None
    assert (directory / "flight.json").read_bytes() == before


def test_the_page_has_the_checks_before_the_flight(
    tiny_run: tuple[Path, Run], tmp_path: Path
) -> None:
    """From preflight.json: the console's table, with words beside each colour; none without it."""
    assert "<h2>Preflight</h2>" not in (tiny_run[0] / "report.html").read_text(encoding="utf-8")
    for name in ("scenario.yaml", "plan.json"):
        shutil.copy(tiny_run[0] / name, tmp_path)
    low = Finding("battery", RED, "30 % <left>", "Charge it.")
    early = Finding("position", AMBER, "GPS fix is 1: not ready yet", "", waits=True)
    fine = Finding("fence", GREEN, "inside its fence")
    pages = (VehiclePage("uav1", (fine, low)), VehiclePage("uav2", (fine, early)))
    write_page(Preflight(pages), tmp_path / "preflight.json")
    rebuild(tmp_path)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    section = page.partition("<h2>Preflight</h2>")[2].partition("<h2>")[0]
    checker = HtmlChecker()
    checker.feed(page)
    assert (checker.amiss, checker.open) == ([], [])
    signs = re.findall(r'<td class="text (\w+)">([^<]+)</td>', section)
    assert signs == [("red", "✗ stop"), ("amber", "… wait"), ("green", "✓ fine")]
    assert "30 % &lt;left&gt;" in section
    assert "not to be flown like this" in section


def test_a_desk_run_has_no_flight(tiny_run: tuple[Path, Run]) -> None:
    """Without a bag nothing is said of a flight."""
    directory, run = tiny_run
    assert run.flight is None
    assert "As flown" not in (directory / "report.html").read_text(encoding="utf-8")


def test_a_bag_without_a_flight_leaves_the_desk_report(
    tiny_run: tuple[Path, Run], tmp_path: Path
) -> None:
    """After a dry run the report is still built, and it is said that nothing was flown."""
    source, _ = tiny_run
    for name in ("scenario.yaml", "plan.json"):
        shutil.copy(source / name, tmp_path)
    bag = FlightBag(tmp_path / "bag")
    bag.lift_off()
    bag.close()
    said: list[str] = []

    class Told(Progress):
        def end(self, stage: str, result: str, detail: str, *, good: bool = True) -> None:
            said.append(f"{stage} {result} {detail} {good}")

    outcome = rebuild(tmp_path, Told())
    assert outcome.flight is None
    assert outcome.report is not None
    assert any("nobody left the ground" in line and "False" in line for line in said)


def test_bags_are_found_in_the_order_they_were_begun(tmp_path: Path) -> None:
    """bag, bag-2 … bag-10; nothing else."""
    for name in ("bag-10", "bag", "bag-2", "baggage", "figures"):
        (tmp_path / name).mkdir()
    (tmp_path / "bag-3").write_text("no folder")
    assert [path.name for path in flight_bags(tmp_path)] == ["bag", "bag-2", "bag-10"]
