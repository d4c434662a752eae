"""What is known of elevation models by the names under which they are distributed."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Product:
    """A distributed model: what its heights are measured from."""

    datum: str
    above_ellipsoid: bool = False


EGM96 = Product("EGM96 geoid (mean sea level)")
_EGM2008 = Product("EGM2008 geoid (mean sea level)")
_NAVD88 = Product("NAVD88 (mean sea level)")
_WGS84 = Product("ellipsoid of WGS 84", above_ellipsoid=True)

# As the producers describe their products; names as files have them when downloaded.
_NAMES = (
    (re.compile(r"Copernicus_DSM_", re.IGNORECASE), _EGM2008),  # GLO-30 and GLO-90
    (re.compile(r"[NS]\d{2}[EW]\d{3}_FABDEM", re.IGNORECASE), _EGM2008),
    (re.compile(r"TDM1_(E?DEM|DCM)_", re.IGNORECASE), _WGS84),  # TanDEM-X
    (re.compile(r"ASTGTMV?\d*_[NS]\d{2}[EW]\d{3}", re.IGNORECASE), EGM96),  # ASTER
    (re.compile(r"(ALPSMLC30_)?[NS]\d{3}[EW]\d{3}(_AVE)?_DSM", re.IGNORECASE), EGM96),  # ALOS
    (re.compile(r"[NS]\d{2}_[EW]\d{3}_[13]arc_v\d", re.IGNORECASE), EGM96),  # SRTM of the USGS
    (re.compile(r"USGS_(13|1|2|1M)_", re.IGNORECASE), _NAVD88),  # 3DEP
)
_SUFFIXES = {".hgt": EGM96, ".dt0": EGM96, ".dt1": EGM96, ".dt2": EGM96}


def product_of(name: str, suffix: str) -> Product | None:
    """The product of a file's name and suffix, None where they tell none."""
    if suffix in _SUFFIXES:
        return _SUFFIXES[suffix]
    return next((product for pattern, product in _NAMES if pattern.match(name)), None)
