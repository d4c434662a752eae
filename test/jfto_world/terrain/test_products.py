"""What files and their names say of heights, and what is said where they say nothing."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
import rasterio
from affine import Affine

from jfto_world.terrain import DeclaredHeights, load_dem

CASES = Path(__file__).parents[2] / "data/cases"
SIZE = (300.0, 300.0)
GEOID_M = 51.9


def tif(path, driver="GTiff"):
    heights = np.full((240, 240), 1500, dtype=np.float32)
    options = {"count": 1, "dtype": "float32", "crs": "EPSG:4326", "height": 240, "width": 240}
    options["transform"] = Affine(1 / 3600, 0, 7.6 - 1 / 30, 0, -1 / 3600, 46.2 + 1 / 30)
    with rasterio.open(path, "w", driver=driver, **options) as dataset:
        dataset.write(heights, 1)
    return path


@pytest.mark.parametrize(
    ("name", "datum", "above_m"),
    [
        ("Copernicus_DSM_COG_10_N46_00_E007_00_DEM.tif", "EGM2008", 0.0),
        ("N46E007_FABDEM_V1-2.tif", "EGM2008", 0.0),
        ("ASTGTMV003_N46E007_dem.tif", "EGM96", 0.0),
        ("ALPSMLC30_N046E007_DSM.tif", "EGM96", 0.0),
        ("n46_e007_1arc_v3.tif", "EGM96", 0.0),
        ("USGS_13_n47w106.tif", "NAVD88", 0.0),
        ("TDM1_DEM__30_N46E007_DEM.tif", "geoid EGM96", GEOID_M),
    ],
)
def test_known_products_tell_their_datum_by_name(tmp_path, name, datum, above_m):
    """Nothing is assumed, so nothing is said; TanDEM-X alone is above the ellipsoid."""
    dem = load_dem(tif(tmp_path / name, "COG"), center=(46.2, 7.6), size_m=SIZE)
    assert datum in dem.height_datum
    assert dem.origin.alt_m == pytest.approx(1500 - above_m, abs=0.2)
    assert len(dem.notes) == (above_m > 0)


def test_heights_of_the_reported_cases():
    """The values of the reported files, to a centimetre; what is declared is converted exactly."""
    for name, declared, alt_m in (
        ("00-ground.tif", "", 1500.0),
        ("09a-stateplane-ft.tif", "us_ft", 6561.7 * 1200 / 3937),
        ("09b-unit-dm.tif", "", 400.0),
        ("10a-antimeridian.tif", "", 300.0),
    ):
        dem = load_dem(CASES / name, center=None, size_m=SIZE, declared=DeclaredHeights(declared))
        assert dem.origin.alt_m == pytest.approx(alt_m, abs=0.01), name


@pytest.mark.parametrize("samples", [1201, 3601])
def test_srtm_in_an_archive_with_voids(tmp_path, samples):
    """1 and 3 arc-seconds as they are downloaded, in a folder; voids elsewhere do no harm."""
    column = np.arange(samples) * (1200 / (samples - 1))
    heights = np.tile(500 + 0.5 * column, (samples, 1)).round().astype(">i2")
    heights[: samples // 4] = -32768
    path = tmp_path / "N46E007.SRTM.hgt.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("L32/N46E007.hgt", heights.tobytes())
    dem = load_dem(path, center=(46.5, 7.5), size_m=SIZE)
    assert dem.origin.alt_m == pytest.approx(800, abs=0.5)
    assert dem.notes == ()
