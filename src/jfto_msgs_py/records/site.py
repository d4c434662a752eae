"""Where may be flown and what is to be seen: survey area and fence, and the part flown at once.

Everything is in local ENU metres about the plan's origin. A ring lists its corners once, without
the first one again at the end, in either direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from jfto_msgs_py.records.fields import FILLED, Range

Ring = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Polygon:
    """One part of an area: its outer ring, and the rings of its holes; (east, north) in metres."""

    outer: Ring
    holes: tuple[Ring, ...] = ()


@dataclass(frozen=True)
class Zone:
    """A no-fly zone: a polygon ring, or a circle where `radius_m` is above 0.

    It reaches from `bottom_m` to `top_m`, heights in the plan's frame; None is without limit.
    """

    name: Annotated[str, FILLED]
    outer: Ring = ()
    centre_m: tuple[float, float] = (0.0, 0.0)
    radius_m: Annotated[float, Range(0.0)] = 0.0
    bottom_m: float | None = None
    top_m: float | None = None


@dataclass(frozen=True)
class Fence:
    """Where the fleet stays: inside every polygon of `keep_in`, and outside every zone.

    `margin_m` is what routes and curves keep from either.
    """

    keep_in: tuple[Polygon, ...] = ()
    keep_out: tuple[Zone, ...] = ()
    margin_m: Annotated[float, Range(0.0)] = 0.0


@dataclass(frozen=True)
class GroundStation:
    """A fixed radio that pictures are sent to: place of its antenna, and its power."""

    position_m: tuple[float, float, float]
    p_max_dbm: float


@dataclass(frozen=True)
class Sortie:
    """Which part of the work this is: `number` 1 … `count`, flown one after another."""

    number: Annotated[int, Range(1)] = 1
    count: Annotated[int, Range(1)] = 1
