"""Records in JSON files: what fits is read, what does not is named with its cure."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

import pytest

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import FileKind, read_record, record_of_text, write_record
from jfto_msgs_py.records.fields import FILLED, MAY_LACK, NULL_IS_NAN, OneOf, Range

KIND = FileKind("log", "Delete it.", format="jfto-log", version=3)


@dataclass(frozen=True)
class Part:
    """A record within a record."""

    name: Annotated[str, FILLED]
    share: Annotated[float, Range(0, 1)]


@dataclass(frozen=True)
class Log:
    """One of everything that files hold."""

    count: Annotated[int, Range(1)]
    mode: Annotated[str, OneOf(("AUTO", "RTL"))]
    place_m: tuple[float, float, float]
    gain: Annotated[float, NULL_IS_NAN]
    since_s: float | None
    parts: tuple[Part, ...]
    rates: Mapping[str, Annotated[float, Range(0.0, above=True)]]
    over: bool
    notes: Mapping[str, Any] = field(default_factory=dict, metadata=MAY_LACK)

    def __post_init__(self) -> None:
        if self.over and self.since_s is None:
            raise InputError("since_s is null, but over is true.")


GOOD = {
    "format": "jfto-log",
    "version": 3,
    "count": 2,
    "mode": "RTL",
    "place_m": [1, 2.5, -3],
    "gain": None,
    "since_s": None,
    "parts": [{"name": "a", "share": 0.5}],
    "rates": {"uav1": 4},
    "over": False,
}


def test_a_record_comes_back_from_its_file(tmp_path) -> None:
    """As it was written, types and all; what may lack is at its default."""
    read = record_of_text(json.dumps(GOOD), "log.json", Log, KIND)
    assert math.isnan(read.gain)
    assert read.place_m == (1.0, 2.5, -3.0)
    assert read.parts == (Part("a", 0.5),)
    assert (read.rates, read.notes) == ({"uav1": 4.0}, {})
    part = Part("b", 1.0)
    write_record(part, tmp_path / "part.json", KIND)
    assert read_record(tmp_path / "part.json", Part, KIND) == part


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"count": 0}, "count is 0, must be at least 1."),
        ({"count": 2.0}, "count is 2.0, must be a whole number."),
        ({"count": True}, "count is true or false, must be a whole number."),
        ({"count": 10**400}, "must be finite."),
        ({"mode": "HOVER"}, "mode is 'HOVER', must be one of AUTO, RTL."),
        ({"place_m": [1, 2]}, "place_m has 2 entries, needs 3."),
        ({"place_m": [1, None, 3]}, "place_m[1] is null, must be a number."),
        ({"parts": [{"name": "", "share": 0}]}, "parts[0].name is empty."),
        ({"parts": [{"name": "a", "share": 2}]}, "parts[0].share is 2, must be 0…1."),
        ({"parts": [{"name": "a"}]}, "parts[0] lacks share."),
        ({"parts": {}}, "parts is an object, must be a list."),
        ({"rates": {"uav1": 0}}, "rates.uav1 is 0, must be positive."),
        ({"cuont": 1}, "has an unknown key cuont. Did you mean count?"),
        ({"over": True}, "since_s is null, but over is true."),
        ({"format": "jfto-plan"}, 'is no log: its key format is not "jfto-log".'),
        ({"version": 2}, "version is 2, this program reads 3."),
    ],
)
def test_what_does_not_fit_is_named_with_its_place(change, words) -> None:
    """File, place, value, what may stand there, and the cure."""
    with pytest.raises(InputError) as caught:
        record_of_text(json.dumps(GOOD | change), "log.json", Log, KIND)
    text = str(caught.value)
    assert text.startswith("log.json: ")
    assert words in text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"count": 1', "log.json:1: is not valid JSON"),
        ('{"count": NaN}', "holds NaN, which JSON does not know. Delete it."),
        ('{"a": 1, "a": 2}', "a is given twice in one object. Remove one."),
        ("[" * 100_000, "is nested too deep. Is it a log file?"),
    ],
)
def test_text_that_is_no_json_is_said_to_be_none(text, words) -> None:
    """With the line where there is one."""
    with pytest.raises(InputError) as caught:
        record_of_text(text, "log.json", Log, KIND)
    assert words in str(caught.value)
