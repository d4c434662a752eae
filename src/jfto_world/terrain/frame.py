"""The local frame: east, north and up in metres about a scenario's origin."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from pyproj import Transformer

from jfto_msgs_py.records.plan import Origin
from jfto_msgs_py.types import Array


@dataclass(frozen=True)
class LocalFrame:
    """Conversion between WGS-84 positions and ENU metres about `origin`.

    A tangent plane, exact at any distance: a point at sea level 1 km away has z = -0.08 m.
    Altitudes are in the datum of `origin.alt_m`, whichever that is, and stay in it. The geoid's
    height above the ellipsoid cancels, to 5 parts per million of horizontal distance.
    """

    origin: Origin

    def to_enu(self, lat_deg: ArrayLike, lon_deg: ArrayLike, alt_m: ArrayLike) -> Array:
        """ENU metres, shape (..., 3), of positions in degrees and metres; arguments broadcast."""
        lat, lon, alt = np.broadcast_arrays(
            *(np.asarray(v, dtype=np.float64) for v in (lat_deg, lon_deg, alt_m))
        )
        return np.stack(_pipeline(self.origin).transform(lon, lat, alt), axis=-1)

    def to_geodetic(self, position_m: ArrayLike) -> tuple[Array, Array, Array]:
        """Latitude, longitude (degrees) and altitude (m) of ENU positions of shape (..., 3)."""
        position = np.asarray(position_m, dtype=np.float64)
        lon, lat, alt = _pipeline(self.origin).transform(
            position[..., 0], position[..., 1], position[..., 2], direction="INVERSE"
        )
        return np.asarray(lat), np.asarray(lon), np.asarray(alt)


@lru_cache(maxsize=16)
def _pipeline(origin: Origin) -> Transformer:
    return Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad "
        "+step +proj=cart +ellps=WGS84 +step +proj=topocentric +ellps=WGS84 "
        f"+lat_0={origin.lat_deg!r} +lon_0={origin.lon_deg!r} +h_0={origin.alt_m!r}"
    )
