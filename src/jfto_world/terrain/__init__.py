"""Elevation models and geodesy."""

from typing import TYPE_CHECKING

from jfto_msgs_py.lazy import lazy_names
from jfto_world.terrain.cubic_surface import CubicSurface
from jfto_world.terrain.dem import Dem
from jfto_world.terrain.frame import LocalFrame

if TYPE_CHECKING:
    from jfto_world.terrain.height_reference import DeclaredHeights
    from jfto_world.terrain.load import DEFAULT_MARGIN_M, load_dem
    from jfto_world.terrain.surface_model import load_surface

__all__ = [
    "DEFAULT_MARGIN_M",
    "CubicSurface",
    "DeclaredHeights",
    "Dem",
    "LocalFrame",
    "load_dem",
    "load_surface",
]
# GDAL takes longer to load than a frame is needed: most nodes only convert coordinates, and one
# that died must soon be back.
__getattr__ = lazy_names(
    __name__,
    dict.fromkeys(("DEFAULT_MARGIN_M", "DeclaredHeights", "load_dem"), "jfto_world.terrain.load")
    | {"load_surface": "jfto_world.terrain.surface_model"},
)
