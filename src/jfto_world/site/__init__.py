"""Where to survey and where not to fly: polygons from files of any kind."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_msgs_py.lazy import lazy_names
from jfto_world.site.site_file import GeoPolygon, Ring, SiteFile, SiteShape

if TYPE_CHECKING:
    from jfto_world.site.area import SiteArea, polygon_area
    from jfto_world.site.local import as_shapely, local_polygons, of_shapely
    from jfto_world.site.polygon_file import SiteKeys, read_site
    from jfto_world.site.rings import ring_polygon

__all__ = [
    "GeoPolygon",
    "Ring",
    "SiteArea",
    "SiteFile",
    "SiteKeys",
    "SiteShape",
    "as_shapely",
    "local_polygons",
    "of_shapely",
    "polygon_area",
    "read_site",
    "ring_polygon",
]

# pyogrio and shapely load GDAL and GEOS: only who reads a file of areas needs them.
__getattr__ = lazy_names(
    __name__,
    {
        "SiteArea": "jfto_world.site.area",
        "SiteKeys": "jfto_world.site.polygon_file",
        "as_shapely": "jfto_world.site.local",
        "local_polygons": "jfto_world.site.local",
        "of_shapely": "jfto_world.site.local",
        "polygon_area": "jfto_world.site.area",
        "read_site": "jfto_world.site.polygon_file",
        "ring_polygon": "jfto_world.site.rings",
    },
)
