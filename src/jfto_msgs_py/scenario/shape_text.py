"""Shapes on the map as a line of text: "circle LAT LON RADIUS m …", "polygon LAT LON LAT LON …"."""

from __future__ import annotations

import math
from dataclasses import dataclass

_FORMS = (
    '"circle LAT LON RADIUS m" or "polygon LAT LON LAT LON LAT LON …", then perhaps '
    '"bottom METRES", "top METRES" and "name WORDS"'
)
_ENDS = ("bottom", "top", "name")


class ShapeTextError(ValueError):
    """What is wrong with a line, to stand behind the name of its key."""


@dataclass(frozen=True)
class ShapeText:
    """A circle where `radius_m` is above 0, its centre the one corner; else a polygon.

    Corners are latitude and longitude in degrees; heights are None where the line gives none.
    """

    corners_deg: tuple[tuple[float, float], ...]
    radius_m: float = 0.0
    bottom_m: float | None = None
    top_m: float | None = None
    name: str = ""


def read_shape(text: str) -> ShapeText:
    """The shape that a line describes.

    Parameters
    ----------
    text
        Such as "circle 36.6255 -84.2650 80 m top 120 name mast"; commas count as spaces.

    Returns
    -------
    ShapeText
        Checked but for crossings of its outline.

    Raises
    ------
    ShapeTextError
        Which word is wrong, and what is wanted.
    """
    words = text.replace(",", " ").split()
    kind = words.pop(0).lower() if words else ""
    if kind not in ("circle", "polygon"):
        raise ShapeTextError(f"begins with {kind!r}, must be {_FORMS}.")
    split = next((k for k, word in enumerate(words) if word.lower() in _ENDS), len(words))
    body, ends = words[:split], words[split:]
    if kind == "circle" and len(body) == 4 and body[3] == "m":
        body.pop()
    numbers = [_number(word, f"in its {kind}") for word in body]
    bottom_m, top_m, name = _ends(ends)
    if kind == "circle":
        if len(numbers) != 3:
            raise ShapeTextError(
                f"has {len(numbers)} numbers, a circle needs latitude, longitude and radius."
            )
        if not 0 < numbers[2] <= 100_000:
            raise ShapeTextError(f"has radius {numbers[2]:g} m, must be above 0…100000 m.")
        return ShapeText(_corners(numbers[:2]), numbers[2], bottom_m, top_m, name)
    if len(numbers) < 6 or len(numbers) % 2:
        raise ShapeTextError(
            f"has {len(numbers)} numbers, a polygon needs latitude and longitude in turn of 3 "
            "corners or more."
        )
    corners = _corners(numbers)
    if corners[0] == corners[-1] and len(corners) > 3:
        corners = corners[:-1]
    return ShapeText(corners, 0.0, bottom_m, top_m, name)


def _corners(numbers: list[float]) -> tuple[tuple[float, float], ...]:
    corners = tuple(zip(numbers[::2], numbers[1::2], strict=True))
    for lat, lon in corners:
        if abs(lat) > 90 or abs(lon) > 180:
            raise ShapeTextError(
                f"has latitude {lat:g}, longitude {lon:g}, which is not on Earth. Give latitude "
                "before longitude, in degrees."
            )
    return corners


def _ends(words: list[str]) -> tuple[float | None, float | None, str]:
    """Heights and name from what follows the numbers."""
    heights: dict[str, float] = {}
    while words:
        word = words.pop(0).lower()
        if word == "name":
            if not words:
                raise ShapeTextError('ends with "name". Add the name, or remove the word.')
            return (*_in_order(heights), " ".join(words))
        if word not in ("bottom", "top"):
            raise ShapeTextError(f"has {word!r} behind its shape, must be {_FORMS}.")
        if word in heights:
            raise ShapeTextError(f"has {word} twice. Remove one.")
        if not words:
            raise ShapeTextError(f'ends with "{word}". Add the height in metres.')
        heights[word] = _number(words.pop(0), f"behind {word}")
        if words and words[0] == "m":
            words.pop(0)
    return (*_in_order(heights), "")


def _in_order(heights: dict[str, float]) -> tuple[float | None, float | None]:
    bottom_m, top_m = heights.get("bottom"), heights.get("top")
    if bottom_m is not None and top_m is not None and bottom_m >= top_m:
        raise ShapeTextError(
            f"has bottom {bottom_m:g} m, not below its top, {top_m:g} m. Exchange them."
        )
    return bottom_m, top_m


def _number(word: str, where: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ShapeTextError(f"has {word!r} {where}, where a number is wanted: {_FORMS}.")
    return value
