"""Elevation models and geodesy."""

from jfto_world.terrain.cubic_surface import CubicSurface
from jfto_world.terrain.dem import Dem
from jfto_world.terrain.frame import LocalFrame
from jfto_world.terrain.load import DEFAULT_MARGIN_M, load_dem

__all__ = ["DEFAULT_MARGIN_M", "CubicSurface", "Dem", "LocalFrame", "load_dem"]
