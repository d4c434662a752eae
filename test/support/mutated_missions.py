"""Mission files with something wrong in them, drawn from a seed, and how much they hold."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

ODD_NUMBERS = ("nan", "inf", "-inf", "1e400", "1e39", "-0", "1_0", "٣", "", "0x10", "99999999999",
               "-5", "2.5", "1e-320", "+7", "46,2", "true", "null")  # fmt: skip
ODD_VALUES: tuple[Any, ...] = (
    None, True, False, "", "x", "16", [], {}, [[]], {"a": 1}, 0, -1, 2.5, 1e308, 10**400, 16, 206,
    5001, 5100, 2000, 195, 115, 95, float("nan"), float("inf"), "ComplexItem", "SimpleItem", 255,
)  # fmt: skip
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "latin-1", "utf-32")


def mutated(content: bytes, suffix: str, rng: random.Random) -> bytes:
    """The file with one to three changes, of its bytes, its lines or its values."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        kind = rng.random()
        if kind < 0.15 or not content:
            content = _bytes_changed(content, rng)
        elif kind < 0.25:
            text = content.decode("utf-8", "replace")
            text = text.replace("\n", rng.choice(("\r\n", "\r", "\n\n", "\x0b", "\u2028")))
            content = text.encode(rng.choice(ENCODINGS), "replace")
        elif suffix in (".plan", ".geojson"):
            content = _json_changed(content, rng)
        else:
            content = _lines_changed(content, rng)
    return content


def _bytes_changed(content: bytes, rng: random.Random) -> bytes:
    data = bytearray(content)
    place = rng.randrange(len(data) + 1)
    kind = rng.randrange(4)
    if kind == 0:
        return bytes(data[:place])
    if kind == 1:
        data[place:place] = bytes(rng.randrange(256) for _ in range(rng.randint(1, 4)))
    elif kind == 2:
        del data[place : place + rng.randint(1, 30)]
    elif place < len(data):
        data[place] = rng.randrange(256)
    return bytes(data)


def _lines_changed(content: bytes, rng: random.Random) -> bytes:
    lines = content.decode("utf-8", "replace").split("\n")
    one, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(5)
    if kind == 0:
        del lines[one]
    elif kind == 1:
        lines.insert(one, lines[other])
    elif kind == 2:
        lines[one], lines[other] = lines[other], lines[one]
    else:
        fields = lines[one].split("\t")
        fields[rng.randrange(len(fields))] = rng.choice(
            (*ODD_NUMBERS, "5100", "5001", "5003", "206", "115", "19")
        )
        lines[one] = "\t".join(fields)
    return "\n".join(lines).encode()


def _json_changed(content: bytes, rng: random.Random) -> bytes:
    try:
        document = json.loads(content.decode("utf-8-sig"))
    except (ValueError, RecursionError):
        return _bytes_changed(content, rng)
    places = [(None, None), *_places(document)]
    box, key = places[rng.randrange(len(places))]
    if box is None:
        document = rng.choice(ODD_VALUES)
    elif rng.random() < 0.25:
        del box[key]
    elif rng.random() < 0.2:
        if isinstance(box, list):
            box.insert(key, box[key])
        else:
            box[f"{key}2"] = box[key]
    else:
        box[key] = rng.choice(ODD_VALUES)
    return json.dumps(document).encode()


def _places(value: Any) -> list[tuple[Any, Any]]:
    keys: Any = ()
    if isinstance(value, dict):
        keys = list(value)
    elif isinstance(value, list):
        keys = range(len(value))
    return [(value, key) for key in keys] + [place for key in keys for place in _places(value[key])]


def count_held(path: Path, text: str) -> int:
    """Items, fence points and rally points in a file that was read, home left out.

    Counted without the readers: rows of a table, entries of lists.
    """
    if path.suffix != ".plan":
        lines = [line.strip() for line in text.replace("\r", "\n").split("\n")]
        rows = [line for line in lines[1:] if line and not line.startswith("#")]
        rows = [line for line in rows if line != "\x1a"]
        return len(rows) - ("110" in lines[0] and bool(rows))
    document = json.loads(text)
    fence = document.get("geoFence") or {}
    return (
        _count_simple(document["mission"]["items"])
        + sum(len(shape["polygon"]) for shape in fence.get("polygons", ()))
        + len(fence.get("circles", ()))
        + bool(fence.get("breachReturn"))
        + len((document.get("rallyPoints") or {}).get("points", ()))
    )


def _count_simple(entries: list[Any]) -> int:
    return sum(
        1
        if entry.get("type") == "SimpleItem"
        else _count_simple(entry["TransectStyleComplexItem"]["Items"])
        for entry in entries
    )
