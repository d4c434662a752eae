"""From WGS-84 to the coordinates of a raster, on whichever datum these are."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from typing import Any

from pyproj import CRS, Transformer
from pyproj.aoi import AreaOfInterest
from pyproj.exceptions import ProjError
from pyproj.transformer import TransformerGroup

from jfto_msgs_py.errors import TerrainError

# Frames that agree with WGS-84 within some 2 m, of which PROJ knows no transformation.
_MODERN = re.compile(
    r"China 2000|North American Datum of 1983|NAD83|NAD_1983|International Terrestrial|"
    r"I(TRF|GS|Gb)\d|SIRGAS|World Geodetic System 1984|WGS.?(19)?84|ETRS|European Terrestrial|"
    r"Israeli Geodetic Datum 2005|Latvian coordinate system 2020",
    re.IGNORECASE,
)
_NAMELESS = re.compile(r"unknown|unnamed|not.specified", re.IGNORECASE)
MODERN_ELLIPSOIDS = re.compile(r"WGS.?(19)?84|GRS.?(19)?80", re.IGNORECASE)
_SAID_FROM_M = 2.5


@dataclass(frozen=True)
class Placing:
    """`transformer` takes longitude and latitude; `note` says how well places are known, or ""."""

    transformer: Transformer
    note: str


def placing(
    crs: CRS,
    name: str,
    bounds_deg: tuple[float, float, float, float],
    tool: str = "gdalwarp",
) -> Placing:
    """The best transformation within bounds (west, south, east, north); `tool` converts files.

    Raises TerrainError where none is known: PROJ would then take coordinates of an old datum
    unshifted, up to some 100 m from where they are.
    """
    datum = crs.geodetic_crs.datum if crs.geodetic_crs else None
    datum_name = datum.name if datum else crs.name
    # pyproj's own types hide that it takes its own record.
    area: Any = AreaOfInterest(*bounds_deg)
    try:
        with warnings.catch_warnings():
            # Of better ones that need grid files that are not there, the note tells.
            warnings.simplefilter("ignore", UserWarning)
            group = TransformerGroup(
                "EPSG:4326",
                crs,
                always_xy=True,
                area_of_interest=area,
                allow_ballpark=False,
            )
        if group.transformers:
            best = group.transformers[0]
            rough = best.accuracy > _SAID_FROM_M
            return Placing(best, f"placed to within {best.accuracy:.0f} m" if rough else "")
        ellipsoid = crs.ellipsoid.name if crs.ellipsoid else ""
        nameless = _NAMELESS.search(datum_name) and MODERN_ELLIPSOIDS.search(ellipsoid)
        if nameless or _MODERN.search(datum_name):
            taken = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
            return Placing(taken, f"datum {datum_name} taken for WGS-84")
    except ProjError as error:
        raise TerrainError(
            f"{name} has a coordinate system ({crs.name}) that cannot be brought to WGS-84 "
            f"({str(error)[:120]}). Convert it with {tool} -t_srs EPSG:4326."
        ) from error
    raise TerrainError(
        f"{name} is on the datum {datum_name}, for which PROJ knows no shift to WGS-84 there; "
        "unshifted it may lie 100 m off. Convert it with the shift of your survey office "
        f"({tool} -s_srs '… +towgs84=…' -t_srs EPSG:4326), or get it on WGS-84."
    )
