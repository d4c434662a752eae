import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.records.plan import Origin
from jfto_world.terrain import LocalFrame

SEMI_MAJOR_M, FLATTENING = 6378137.0, 1 / 298.257223563


def ecef(lat_deg, lon_deg, alt_m):
    """Textbook formula, written apart from the code under test."""
    lat, lon = np.radians(lat_deg), np.radians(lon_deg)
    squared = FLATTENING * (2 - FLATTENING)
    radius = SEMI_MAJOR_M / np.sqrt(1 - squared * np.sin(lat) ** 2)
    return np.array(
        [
            (radius + alt_m) * np.cos(lat) * np.cos(lon),
            (radius + alt_m) * np.cos(lat) * np.sin(lon),
            (radius * (1 - squared) + alt_m) * np.sin(lat),
        ]
    )


@settings(deadline=None, derandomize=True, max_examples=40)
@given(
    st.floats(-80, 80),
    st.floats(-179, 179),
    st.floats(-400, 8000),
    st.floats(-0.1, 0.1),
    st.floats(-0.1, 0.1),
    st.floats(-400, 8000),
)
def test_enu_is_the_rotated_difference_of_earth_centred_positions(lat, lon, alt, dlat, dlon, up):
    """to_enu equals R (p - p0) with the textbook rotation, to a millimetre."""
    phi, lam = np.radians(lat), np.radians(lon)
    rotation = np.array(
        [
            [-np.sin(lam), np.cos(lam), 0],
            [-np.sin(phi) * np.cos(lam), -np.sin(phi) * np.sin(lam), np.cos(phi)],
            [np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)],
        ]
    )
    expected = rotation @ (ecef(lat + dlat, lon + dlon, up) - ecef(lat, lon, alt))
    frame = LocalFrame(Origin(lat, lon, alt))
    assert frame.to_enu(lat + dlat, lon + dlon, up) == pytest.approx(expected, abs=1e-3)


@settings(deadline=None, derandomize=True, max_examples=40)
@given(
    st.floats(-80, 80),
    st.floats(-179, 179),
    st.floats(-20e3, 20e3),
    st.floats(-20e3, 20e3),
    st.floats(-500, 5000),
)
def test_geodetic_and_back_is_the_same_point(lat, lon, x, y, z):
    """to_enu undoes to_geodetic to a millimetre."""
    frame = LocalFrame(Origin(lat, lon, 500.0))
    back = frame.to_enu(*frame.to_geodetic(np.array([x, y, z])))
    assert back == pytest.approx([x, y, z], abs=1e-3)


def test_the_earth_curves_away_below_the_tangent_plane():
    """A point at the origin's altitude 1 km away lies 8 cm below the plane (d²/2R)."""
    frame = LocalFrame(Origin(40.0, -105.0, 0.0))
    north = frame.to_enu(40.0 + 1000 / 111_034.6, -105.0, 0.0)
    assert north == pytest.approx([0.0, 1000.0, -0.0785], abs=0.02)


def test_arrays_keep_their_shape():
    """Inputs broadcast and the result adds an axis of three."""
    frame = LocalFrame(Origin(40.0, -105.0, 0.0))
    assert frame.to_enu(np.full((2, 3), 40.0), -105.0, 10.0).shape == (2, 3, 3)
    lat, lon, alt = frame.to_geodetic(np.zeros((4, 5, 3)))
    assert lat.shape == lon.shape == alt.shape == (4, 5)
