"""What the author of a wrong key or value probably meant."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable

from jfto_msgs_py.scenario.key import Key

_LEADING_NUMBER = re.compile(r"^\s*([-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)\s*[^\d\s]")
# Slips of the pen and of the unit, most likely first.
_SLIPS = (
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
