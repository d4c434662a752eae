"""How well elevation models agree where they overlap."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array

# Equal but for rounding; and more than a surface model may lie above a terrain model.
_SAID_FROM_M, _REFUSED_FROM_M = 0.05, 40.0


class Overlap:
    """What was found so far, of any number of pairs."""

    def __init__(self) -> None:
        self._worst: dict[tuple[str, str], float] = {}

    def compare(self, first: tuple[str, Array], second: tuple[str, Array]) -> None:
        """Take in heights of two models, each with its name, at the same places; NaN is none.

        Raises TerrainError where they cannot be of one ground in one unit above one datum.
        """
        names = first[0], second[0]
        off = np.abs(first[1] - second[1])
        off = off[np.isfinite(off)]
        if not off.size:
            return
        typical_m = float(np.median(off))
        if typical_m > _REFUSED_FROM_M:
            raise TerrainError(
                f"{names[0]} and {names[1]} overlap and differ by {typical_m:.0f} m there: their "
                "heights are in other units or above other datums. Move one elsewhere, or convert "
                "it (gdalwarp)."
            )
        self._worst[names] = max(self._worst.get(names, 0.0), float(off.max()))

    def notes(self) -> tuple[str, ...]:
        """A line for the pair that differs most, none where all agree."""
        said = {names: off for names, off in self._worst.items() if off > _SAID_FROM_M}
        if not said:
            return ()
        (first, second), off_m = max(said.items(), key=lambda item: item[1])
        others = f", {len(said) - 1} more pairs by less" if len(said) > 1 else ""
        off = f"overlap and differ by up to {off_m:.2f} m there{others}"
        return (f"{first} and {second} {off}; the first is taken",)
