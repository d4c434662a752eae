"""One elevation model of the several that may lie under an area."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from jfto_msgs_py.types import Array, Flags
from jfto_world.terrain.frame import LocalFrame

# Heights in metres above a layer's own datum at latitudes and longitudes in degrees, arrays of one
# shape; NaN where there are none.
Heights = Callable[[Array, Array], Array]


class Layer(Protocol):
    """A grid of heights anywhere on earth, of which a part is read for an area."""

    @property
    def name(self) -> str:
        """File or folder, for messages."""

    @property
    def system(self) -> str:
        """Name of its coordinate system."""

    @property
    def height_datum(self) -> str:
        """What its heights are measured from."""

    @property
    def above_ellipsoid(self) -> bool:
        """Whether that is the ellipsoid and not sea level."""

    @property
    def placed(self) -> str:
        """How well its places on earth are known, "" where within a few metres."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What was taken for granted, a line each."""

    def cell_m(self, frame: LocalFrame) -> float:
        """The shorter side of a cell at the frame's origin, m; inf where it does not reach."""

    def covers(self, lat_deg: Array, lon_deg: Array, beyond: float = 0.0) -> Flags:
        """Whether places lie between the centres of its cells, or `beyond` cells outside."""

    def heights(
        self, lat_deg: Array, lon_deg: Array, spacing_m: float, cell_m: float, zero_is_void: bool
    ) -> Heights:
        """Read what lies under places; they are `spacing_m` apart, cells `cell_m` wide.

        Cells that are finer than the spacing are averaged. The result serves these places and
        others a few metres off. Raises TerrainError where heights cannot be read or are absurd.
        """

    def middle(self) -> tuple[float, float]:
        """Latitude and longitude of its middle, degrees."""

    def extent_text(self) -> str:
        """What it covers, for messages."""
