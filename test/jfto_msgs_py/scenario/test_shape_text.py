"""Zones as a line of text in a scenario."""

import pytest

from jfto_msgs_py.errors import ScenarioError
from jfto_msgs_py.scenario import Given, make_scenario
from jfto_msgs_py.scenario.shape_text import ShapeText, ShapeTextError, read_shape


@pytest.mark.parametrize(
    ("text", "shape"),
    [
        (
            "circle 36.6255 -84.2650 80 m top 120",
            ShapeText(((36.6255, -84.265),), 80.0, None, 120.0),
        ),
        ("Circle 1, 2, 3", ShapeText(((1.0, 2.0),), 3.0)),
        (
            "polygon 1 2 1 3 2 3 1 2 bottom 5 m top 9 name north mast",
            ShapeText(((1.0, 2.0), (1.0, 3.0), (2.0, 3.0)), 0.0, 5.0, 9.0, "north mast"),
        ),
    ],
)
def test_a_line_is_read(text, shape):
    """Numbers, then heights and a name in words; commas count as spaces, rings may be closed."""
    assert read_shape(text) == shape


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "begins with ''"),
        ("square 1 2 3", "begins with 'square'"),
        ("circle 1 2", "2 numbers, a circle needs"),
        ("circle 1 2 -3", "radius -3 m"),
        ("circle 1 2 3 km", "'km' in its circle"),
        ("circle 1 2 nan", "'nan' in its circle"),
        ("circle 100 2 3", "latitude before longitude"),
        ("polygon 1 2 1 3 2", "5 numbers"),
        ("polygon 1 2 1 3", "4 numbers"),
        ("circle 1 2 3 top", 'ends with "top"'),
        ("circle 1 2 3 top high", "'high' behind top"),
        ("circle 1 2 3 top 5 top 6", "top twice"),
        ("circle 1 2 3 bottom 6 top 5", "not below its top"),
        ("circle 1 2 3 name", 'ends with "name"'),
    ],
)
def test_a_wrong_line_is_refused_with_the_word(text, reason):
    """Whatever is not understood is named, with what is wanted."""
    with pytest.raises(ShapeTextError, match=reason):
        read_shape(text)


def test_a_scenario_names_key_and_place():
    """Every wrong zone of a scenario is listed with key, number and origin."""
    wrong = {
        "fence.keep_out": Given(["circle 1 2 3", "circle 1 2"], "mine.yaml:7"),
        "fence.keep_in": Given(["circle 1 2 3 top 4"], "mine.yaml:9"),
        "fence.layer": Given("a", "mine.yaml:10"),
    }
    with pytest.raises(ScenarioError) as caught:
        make_scenario([wrong])
    first, second, third = caught.value.problems
    assert first.startswith("mine.yaml:7: fence.keep_out [1] has 2 numbers")
    assert second.startswith("mine.yaml:9: fence.keep_in [0] has a height")
    assert third.startswith("mine.yaml:10: fence.layer needs fence.file")
