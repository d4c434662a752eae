"""One value against one key, and what its author probably meant."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from jfto_msgs_py.records.fields import Key

_LEADING_NUMBER = re.compile(r"^\s*([-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)\s*[^\d\s]")
# Slips of the pen and of the unit, most likely first.
_SLIPS: tuple[Callable[[float], float], ...] = (
    lambda v: -v,
    lambda v: v / 10,
    lambda v: v * 10,
    lambda v: v / 100,
    lambda v: v * 100,
    lambda v: v / 1000,
    lambda v: v * 1000,
    lambda v: v * 1e6,
    lambda v: v * 1e9,
)
_KIND_NAMES = {
    "bool": "true or false",
    "int": "a whole number",
    "float": "a number",
    "text": "text",
}


@dataclass(frozen=True)
class Given:
    """A value as somebody gave it, and where: "config/mine.yaml:12" or "--set"."""

    value: Any
    origin: str


def check_value(key: Key, given: Given) -> tuple[Any, list[str]]:
    """Value of the type that `key` asks for, and every problem found with it.

    Numbers are taken for one-entry arrays where an array is asked for.
    """
    value = given.value
    if not key.array:
        if isinstance(value, list):
            return None, [_say(given, key.name, value, f"must be {_KIND_NAMES[key.kind]}, no list")]
        entry, problem = _check_entry(key, key.name, given, value)
        return entry, [problem] if problem else []
    entries = value if isinstance(value, list) else [value]
    problems = []
    if key.length is not None and len(entries) != key.length:
        what = f"has {len(entries)} entries, needs {key.length}"
        problems.append(f"{given.origin}: {key.name} {what}: {_first_sentence(key.doc)}")
    checked = []
    for index, entry in enumerate(entries):
        name = f"{key.name}[{index}]" if isinstance(value, list) else key.name
        result, problem = _check_entry(key, name, given, entry)
        checked.append(result)
        if problem:
            problems.append(problem)
    return tuple(checked), problems


def _check_entry(key: Key, name: str, given: Given, value: Any) -> tuple[Any, str]:
    if isinstance(value, list | dict):
        return None, _say(given, name, value, f"must be {_KIND_NAMES[key.kind]}")
    if key.kind == "bool":
        if isinstance(value, bool):
            return value, ""
        return None, _say(given, name, value, "must be true or false")
    if key.kind == "text":
        return _check_text(key, name, given, value)
    return _check_number(key, name, given, value)


def _check_text(key: Key, name: str, given: Given, value: Any) -> tuple[Any, str]:
    if not isinstance(value, str):
        return None, _say(given, name, value, f'must be text. Write "{value}" in quotes')
    if key.choices and value not in key.choices:
        guess = nearest(value, key.choices)
        cure = f". Did you mean {guess}?" if guess else ""
        return None, _say(given, name, value, f"must be one of {', '.join(key.choices)}{cure}")
    return value, ""


def _check_number(key: Key, name: str, given: Given, value: Any) -> tuple[Any, str]:
    wanted = _KIND_NAMES[key.kind]
    unit = f" in {key.unit}" if key.unit else ""
    if isinstance(value, bool) or not isinstance(value, int | float):
        guess = number_in(value) if isinstance(value, str) else ""
        cure = f". Did you mean {guess}?" if guess else ""
        return None, _say(given, name, value, f"must be {wanted}{unit} ({key.range_text}){cure}")
    if not math.isfinite(value):
        return None, _say(given, name, value, f"must be finite ({key.range_text})")
    if key.kind == "int" and value != int(value):
        return None, _say(given, name, value, f"must be {wanted}. Did you mean {round(value)}?")
    if not in_range(key, value):
        guess = likely_value(key, value)
        cure = f". Did you mean {guess}?" if guess else ". Give a value inside the range."
        return None, _say(given, name, value, f"outside {key.range_text}{cure}")
    return (int(value) if key.kind == "int" else float(value)), ""


def _say(given: Given, name: str, value: Any, reason: str) -> str:
    shown = f"{value:.12g}" if isinstance(value, float) else repr(value)
    if len(shown) > 60:
        shown = shown[:57] + "…"
    end = "" if reason.endswith(("?", ".")) else "."
    return f"{given.origin}: {name} is {shown}, {reason}{end}"


def _first_sentence(doc: str) -> str:
    head = doc.partition(". ")[0]
    return head if head.endswith(".") else head + "."


def nearest(word: str, known: Iterable[str]) -> str:
    """Known word closest to a mistyped one, "" where nothing is close.

    A dotted key is compared as a whole, then by its last part alone, so that a right name under a
    wrong part is still found.
    """
    candidates = list(known)
    close = difflib.get_close_matches(word, candidates, n=1, cutoff=0.75)
    if close:
        return close[0]
    by_leaf = {name.rsplit(".", 1)[-1]: name for name in candidates}
    close = difflib.get_close_matches(word.rsplit(".", 1)[-1], list(by_leaf), n=1, cutoff=0.75)
    return by_leaf[close[0]] if close else ""


def likely_value(key: Key, value: float) -> str:
    """Value inside the range of `key` that a slip turns into `value`, "" where none is likely."""
    for slip in _SLIPS:
        candidate = slip(value)
        if key.kind == "int" and candidate != int(candidate):
            continue
        if value and in_range(key, candidate):
            return f"{candidate:g}"
    return ""


def number_in(text: str) -> str:
    """Number at the head of a text such as "30 dBm", "" where there is none."""
    match = _LEADING_NUMBER.match(text)
    return match.group(1) if match else ""


def in_range(key: Key, value: float) -> bool:
    """Whether a finite number lies inside the range of `key`."""
    if key.strict:
        return (key.low is None or value > key.low) and (key.high is None or value < key.high)
    return (key.low is None or value >= key.low) and (key.high is None or value <= key.high)
