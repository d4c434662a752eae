"""The nodes at which an area's ground is taken from its elevation models."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import TerrainError
from jfto_msgs_py.types import Array
from jfto_world.terrain.frame import LocalFrame
from jfto_world.terrain.layer import Layer

DEFAULT_MARGIN_M = 500.0
# Shares of the default margin that are tried where a model ends near the area.
_MARGIN_SHARES = (1.0, 0.7, 0.5, 0.3, 0.2, 0.1, 0.0)
_LARGEST_M = 100_000.0
# Three nodes per source cell keep the second interpolation within centimetres of the first.
_NODES_PER_CELL = 3
_MOST_NODES = 1000
# Where models meet that are of different grids, the outer half of their last cells fills the seam.
SEAM_CELLS = 0.51
_PROBES = 129


@dataclass(frozen=True)
class AreaGrid:
    """Nodes x (nx,) and y (ny,) in metres, of the area with its margin, `half_m` either way.

    `lat`, `lon` (ny, nx) are the nodes on the level of the origin; `cell_m` is the finest cell.
    """

    half_m: tuple[float, float]
    x: Array
    y: Array
    lat: Array
    lon: Array
    cell_m: float

    @property
    def spacing_m(self) -> float:
        """The shorter distance between nodes."""
        return float(min(self.x[1] - self.x[0], self.y[1] - self.y[0]))


def check_center(name: str, center: tuple[float, float]) -> tuple[float, float]:
    """Latitude and longitude as given. Raises TerrainError where they can be none."""
    lat_deg, lon_deg = float(center[0]), float(center[1])
    if not (-90 < lat_deg < 90 and -180 <= lon_deg <= 180):
        raise TerrainError(
            f"{name}: centre ({lat_deg}, {lon_deg}) is not a latitude and longitude in "
            "degrees. Give latitude first."
        )
    return lat_deg, lon_deg


def check_size(size_m: tuple[float, float], margin_m: float | None) -> None:
    """Raise TerrainError for an area of no size, or an absurd one."""
    if not all(0 < side <= _LARGEST_M for side in size_m):
        raise TerrainError(
            f"size_m is {tuple(size_m)}, both sides must be positive and at most 100 km."
        )
    if margin_m is not None and not 0 <= margin_m <= _LARGEST_M:
        raise TerrainError(f"margin_m is {margin_m}, must be between 0 and 100 km.")


def layers_under(
    layers: Sequence[Layer], frame: LocalFrame, size_m: tuple[float, float], margin_m: float | None
) -> tuple[Layer, ...]:
    """Those that lie under some of the area or its margin, finest first; all where none does."""
    margin = DEFAULT_MARGIN_M if margin_m is None else margin_m
    lat, lon = _nodes(
        frame, *(np.linspace(-0.5, 0.5, _PROBES) * (side + 2 * margin) for side in size_m)
    )

    def under(layer: Layer) -> bool:
        # One may be smaller than the probes are apart.
        east, north, _ = frame.to_enu(*layer.middle(), 0.0)
        half = [side / 2 + margin for side in size_m]
        within = abs(east) <= half[0] and abs(north) <= half[1]
        return bool(within or layer.covers(lat, lon, SEAM_CELLS).any())

    below = [layer for layer in layers if under(layer)]
    return tuple(sorted(below or layers, key=lambda layer: layer.cell_m(frame)))


def area_grid(
    layers: Sequence[Layer],
    frame: LocalFrame,
    size_m: tuple[float, float],
    margin_m: float | None,
    name: str,
    *,
    in_folder: bool = False,
) -> AreaGrid:
    """Nodes of the area and the widest margin that the layers cover.

    Raises TerrainError where they do not cover the area itself, or `margin_m` where that is given.
    """
    cell_m = min(layer.cell_m(frame) for layer in layers)
    if not math.isfinite(cell_m):
        origin = frame.origin
        raise TerrainError(
            f"{name}: centre ({origin.lat_deg}, {origin.lon_deg}) lies outside the reach "
            f"of its coordinate system. It covers {_extents(layers)}."
        )
    beyond = 0.0 if len(layers) == 1 else SEAM_CELLS
    wide = DEFAULT_MARGIN_M
    margins = [margin_m] if margin_m is not None else [share * wide for share in _MARGIN_SHARES]
    for margin in margins:
        half = (size_m[0] / 2 + margin, size_m[1] / 2 + margin)
        x, y = _axes(half, cell_m)
        lat, lon = _nodes(frame, x, y)
        inside = np.any([layer.covers(lat, lon, beyond) for layer in layers], axis=0)
        if inside.all():
            return AreaGrid(half, x, y, lat, lon, cell_m)
    row, column = np.argwhere(~inside)[0]
    with_margin = f" with its margin of {margin_m:.0f} m" if margin_m else ""
    cure = "size_m or margin_m" if margin_m else "size_m"
    tile = (
        f"Add the tile that lies there, move the centre, or make {cure} smaller."
        if in_folder
        else f"Move the centre, make {cure} smaller, or put the neighbouring tile into the same "
        "folder and name that."
    )
    raise TerrainError(
        f"{name} covers only {100 * float(np.mean(inside)):.0f} % of the area{with_margin}: it "
        f"holds {_extents(layers)}; the first gap is at {float(lat[row, column]):.5f}, "
        f"{float(lon[row, column]):.5f}. {tile}"
    )


def _extents(layers: Sequence[Layer]) -> str:
    return " and ".join(layer.extent_text() for layer in layers[:3])


def _nodes(frame: LocalFrame, x: Array, y: Array) -> tuple[Array, Array]:
    nodes = np.stack([*np.meshgrid(x, y), np.zeros((len(y), len(x)))], axis=-1)
    return frame.to_geodetic(nodes)[:2]


def _axes(half: tuple[float, float], cell_m: float) -> tuple[Array, Array]:
    """Node coordinates, an odd number per axis so that one lies on the origin."""

    def axis(half_side: float) -> Array:
        spacing = max(cell_m / _NODES_PER_CELL, 2 * max(half) / _MOST_NODES)
        steps = max(2, math.ceil(half_side / spacing))
        return np.linspace(-half_side, half_side, 2 * steps + 1)

    return axis(half[0]), axis(half[1])
