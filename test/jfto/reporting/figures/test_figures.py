"""Every figure of a plan and of a flight. Warnings are errors here, as in all tests."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

from jfto.analysis.comparison import compare
from jfto.analysis.facts import FlightFacts, facts_of
from jfto.pipeline.run import Run
from jfto.planning.survey import Survey
from jfto.reporting.figures import draw, flight_drawings, plan_drawings
from jfto.reporting.figures.map import nice_length
from jfto.reporting.figures.motion import flight_profiles
from jfto_msgs_py.records.event import ERROR, WARN, Event
from jfto_msgs_py.records.plan import Plan
from support.fleets import START_NS
from support.flights import Flaws, recorded

MAPS = {"routes", "topology", "flown_map"}
# A quantity with its unit in brackets; what is counted has none.
WITH_UNIT = re.compile(r".+ \(.+\)$")
COUNTED = re.compile(r"Slot n|Neighbours.*|Planned arrival.*")


@pytest.fixture(scope="module")
def troubled(tiny_run: tuple[Path, Run], tiny_survey: Survey) -> FlightFacts:
    """A flight with everything that figures mark: late, lost, missed waypoints, events."""
    run = tiny_run[1]
    assert run.comparison is not None
    flaws = Flaws(late_s={"uav2": 4.0}, off_m={"uav3": (0.0, 0.0, 30.0)}, gone_s={"uav4": 70.0})
    events = [
        Event(WARN, "link", "uav4", "uav4 is silent", START_NS + 5 * 10**9, "mavlink_bridge"),
        Event(ERROR, "gps", "uav1", "uav1 is lost", START_NS + 9 * 10**9, "mavlink_bridge"),
    ]
    flight = recorded(run.plan, run.comparison.ours.power_w, flaws, events)
    ours = run.comparison.ours
    return facts_of(flight, run.plan, ours, tiny_survey.dem, n_dc=5, clearance_m=0.0)


@pytest.fixture(scope="module")
def figures(
    tiny_run: tuple[Path, Run], tiny_survey: Survey, troubled: FlightFacts
) -> dict[str, Figure]:
    """All figures, laid out."""
    run = tiny_run[1]
    assert run.comparison is not None
    drawings = {
        **plan_drawings(run.plan, run.comparison, tiny_survey.dem, 5),
        **flight_drawings(troubled, tiny_survey.dem),
    }
    made = {stem: drawing() for stem, drawing in drawings.items()}
    for figure in made.values():
        figure.draw_without_rendering()
    return made


def _texts(figure: Figure) -> list[str]:
    return [text.get_text() for axes in figure.axes for text in axes.texts]


def test_every_axis_says_what_it_shows_and_in_which_unit(figures: dict[str, Figure]) -> None:
    """Outer axes are labelled, or their panel's title names the quantity; units are in brackets."""
    assert len(figures) == 10
    for stem, figure in figures.items():
        labels = [axes.get_xlabel() for axes in figure.axes]
        labels += [axes.get_ylabel() or axes.get_title() for axes in figure.axes]
        labels = [label for label in labels if label and not re.fullmatch(r"uav\d", label)]
        assert labels, stem
        for label in labels:
            named = WITH_UNIT.match(label) or COUNTED.match(label) or label.startswith("(")
            assert named, (stem, label)


@pytest.mark.parametrize("stem", sorted(MAPS))
def test_maps_have_a_scale_bar_of_its_length_and_north(
    figures: dict[str, Figure], stem: str
) -> None:
    """The bar's patches are as long on the map as its label says; east and north are metres."""
    figure = figures[stem]
    scaled = next(axes for axes in figure.axes if len(axes.patches) >= 2)
    left, right = scaled.patches[:2]
    # Contours are labelled in metres too; the bar's label stands over its middle.
    words = next(t.get_text() for t in scaled.texts if t.get_position()[0] == right.get_x())
    length_m = float(words.split()[0]) * {"m": 1, "km": 1000}[words.split()[1]]
    assert left.get_width() + right.get_width() == pytest.approx(length_m)
    assert "N" in _texts(figure)
    assert figure.axes[-1].get_xlabel() == "East of origin (m)"
    assert figure.axes[0].get_ylabel() == "North of origin (m)"
    assert scaled.get_aspect() == 1.0


def test_routes_are_drawn_where_they_are(
    tiny_run: tuple[Path, Run], figures: dict[str, Figure]
) -> None:
    """Each UAV's line goes from its pad through its waypoints, and the legend says how long."""
    plan = tiny_run[1].plan
    (axes,) = figures["routes"].axes
    lines = [line for line in axes.lines if str(line.get_label()).startswith("uav")]
    for index, line in enumerate(lines):
        assert np.array_equal(line.get_xydata(), plan.line_m(index)[:, :2])
        assert f"{plan.routes[index].length_m / 1000:.2f} km" in str(line.get_label())
    assert len(lines) == len(plan.uavs)


def test_throughput_is_the_comparisons(
    tiny_run: tuple[Path, Run], figures: dict[str, Figure]
) -> None:
    """A line per algorithm in Gb/s from slot 1 on."""
    comparison = tiny_run[1].comparison
    assert comparison is not None
    (axes,) = figures["throughput"].axes
    drawn = {str(line.get_label()).split(",")[0]: line.get_ydata() for line in axes.lines}
    for result in comparison.results:
        assert drawn[result.name] == pytest.approx(result.linked.throughput_bps[1:] / 1e9)


def test_a_flight_shows_what_went_wrong(troubled: FlightFacts, figures: dict[str, Figure]) -> None:
    """Missed waypoints, exceptions and events are marked, and lateness has its size."""
    (flown,) = figures["flown_map"].axes
    assert {"waypoint missed", "exception", "planned"} <= {
        str(line.get_label()) for line in flown.lines
    }
    assert {"link", "gps"} <= set(_texts(figures["flown_events"]))
    late = {
        str(line.get_label()): line.get_ydata() for line in figures["flown_timing"].axes[0].lines
    }
    assert np.asarray(late["uav2"], dtype=float) == pytest.approx(4.0, abs=0.25)
    assert not troubled.good


def test_a_uav_without_waypoints_leaves_the_layout_alone(
    tiny_guided: Plan, tiny_survey: Survey
) -> None:
    """Its row is as wide as the others: an empty line once made all panels collapse."""
    first, *others = tiny_guided.routes
    idle = replace(first, waypoint_ids=(), arrival_s=(), length_m=0.0)
    plan = replace(
        tiny_guided, routes=(idle, *others), time_model="constant_speed", time_parameters={},
        trajectories=(),
    )  # fmt: skip
    figure = flight_profiles(plan, tiny_survey.dem)
    figure.draw_without_rendering()
    widths = [axes.get_position().width for axes in figure.axes]
    assert min(widths) > 0.3


@pytest.mark.slow
def test_figures_are_files_for_screen_and_print_the_same_each_time(
    tiny_run: tuple[Path, Run], tmp_path: Path
) -> None:
    """PNG and PDF of each drawing, with the same bytes when drawn again."""
    run = tiny_run[1]
    assert run.comparison is not None
    drawings = plan_drawings(run.plan, run.comparison, None, 5)
    files = draw(drawings, tmp_path / "one")
    again = draw(drawings, tmp_path / "two")
    assert [file.name for file in files] == [
        "throughput.png", "throughput.pdf", "degree_energy.png", "degree_energy.pdf",
    ]  # fmt: skip
    assert [file.read_bytes() for file in files] == [file.read_bytes() for file in again]
    assert imread(files[0]).shape[1] == round(7.16 * 220)


def test_without_terrain_there_are_no_maps(tiny_run: tuple[Path, Run]) -> None:
    """What needs no ground is drawn all the same."""
    plan = tiny_run[1].plan
    assert set(plan_drawings(plan, compare(plan, 5), None, 5)) == {"throughput", "degree_energy"}


@pytest.mark.parametrize(("wide", "nice"), [(0.9, 0.5), (1.0, 1.0), (47.0, 20.0), (5000.0, 5000.0)])
def test_scale_bars_have_round_lengths(wide: float, nice: float) -> None:
    """The greatest of 1, 2, 5 × 10^k that fits."""
    assert nice_length(wide) == pytest.approx(nice)
