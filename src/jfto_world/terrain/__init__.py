"""Elevation models and geodesy."""

from typing import TYPE_CHECKING

from jfto_world.terrain.cubic_surface import CubicSurface
from jfto_world.terrain.dem import Dem
from jfto_world.terrain.frame import LocalFrame

if TYPE_CHECKING:
    from jfto_world.terrain.height_reference import DeclaredHeights
    from jfto_world.terrain.load import DEFAULT_MARGIN_M, load_dem

__all__ = ["DEFAULT_MARGIN_M", "CubicSurface", "DeclaredHeights", "Dem", "LocalFrame", "load_dem"]


def __getattr__(name: str) -> object:
    """What reads rasters, when first asked for: GDAL takes longer to load than a frame is needed.

    Most nodes only convert coordinates, and one that died must soon be back.
    """
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from jfto_world.terrain import load

    return getattr(load, name)
