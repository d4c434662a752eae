"""Elevation models that cannot be used: each refusal names file, key and cure."""

from __future__ import annotations

import gzip
import zipfile

import numpy as np
import pytest
import rasterio
from affine import Affine

from jfto.planning.scenario_file import load_scenario
from jfto.planning.terrain import load_ground
from jfto_msgs_py.errors import TerrainError
from jfto_world.terrain import DeclaredHeights, load_dem, packed

SCENARIO = """
/**:
  ros__parameters:
    terrain:
      source: "{source}"
      size_m: [200.0, 200.0]
"""
SLOPE = np.tile(1000 + 2 * np.arange(240, dtype=np.float32), (240, 1))
MOSAIC = (
    '<VRTDataset rasterXSize="10" rasterYSize="10"><SRS>EPSG:4326</SRS>'
    "<GeoTransform>7,0.1,0,46,0,-0.1</GeoTransform>"
    '<VRTRasterBand dataType="Int16" band="1"><SimpleSource>'
    "<SourceFilename{}>{}</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>"
)


def tif(path, heights=SLOPE, *, crs="EPSG:4326", west=7.5, north=46.3, cell=1 / 1200, **profile):
    colours = profile.pop("colours", None)
    options = {"driver": "GTiff", "count": 1, "dtype": heights.dtype, "crs": crs} | profile
    options |= {"height": heights.shape[0], "width": heights.shape[1]}
    options["transform"] = Affine(cell, 0, west, 0, -cell, north)
    with rasterio.open(path, "w", **options) as dataset:
        dataset.write(heights, 1)
        if colours:
            dataset.write_colormap(1, colours)


def zipped(path, *names):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.writestr(name, b"content")


def locked(path):
    zipped(path, "a.tif")
    content = bytearray(path.read_bytes())
    content[6] |= 1
    content[content.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(content)


def cut(path):
    tif(path)
    path.write_bytes(path.read_bytes()[:2000])


# Name, how the file comes about, reason and cure.
BAD = {
    "truncated": ("a.tif", cut, "cannot be read", "download"),
    "gzip truncated": (
        "N46E007.hgt.gz",
        lambda p: p.write_bytes(gzip.compress(bytes(2884802))[:-200]),
        "cannot be unpacked",
        "download it again",
    ),
    "an .hgt cut before it was packed": (
        "N46E007.hgt.gz",
        lambda p: p.write_bytes(gzip.compress(bytes(2884800))),
        "holds a tile of 2884800 bytes, an SRTM tile has 2884802 (3 arc-seconds)",
        "download it again",
    ),
    "complex": (
        "a.tif",
        lambda p: tif(p, np.zeros((50, 50), np.complex64)),
        "complex64 values, not heights",
        "Name an elevation model",
    ),
    "palette": (
        "a.tif",
        lambda p: tif(p, np.full((50, 50), 7, np.uint8), colours={7: (10, 20, 30, 255)}),
        "colours from a palette",
        "that it was drawn from",
    ),
    "all void": (
        "a.tif",
        lambda p: tif(p, np.full((240, 240), -9999, np.float32), nodata=-9999),
        "100 % of the area or its margin is without a height, first at 46.",
        "gdal_fillnodata",
    ),
    "all NaN": (
        "a.tif",
        lambda p: tif(p, np.full((240, 240), np.nan, np.float32)),
        "100 % of the area",
        "Move the centre",
    ),
    "no system": ("a.tif", lambda p: tif(p, crs=None), "names no coordinate system", "-a_srs"),
    "degrees as metres": (
        "a.tif",
        lambda p: tif(p, crs="EPSG:32632"),
        "said to be in metres (WGS 84 / UTM zone 32N)",
        "-a_srs EPSG:4326",
    ),
    "metres as degrees": (
        "a.tif",
        lambda p: tif(p, west=400_000, north=5_100_000, cell=10),
        "said to be in degrees (WGS 84), but has coordinates up to 5100000",
        "-a_srs",
    ),
    "old datum": (
        "a.tif",
        lambda p: tif(p, crs="EPSG:2334", west=18_500_000, north=3_640_000, cell=10),
        "on the datum Xian 1980, for which PROJ knows no shift",
        "towgs84",
    ),
    "several in a zip": (
        "a.zip",
        lambda p: zipped(p, "a.tif", "b.hgt"),
        "holds 2 elevation models",
        "Unpack it",
    ),
    "none in a zip": ("a.zip", lambda p: zipped(p, "a.txt"), "holds 0", "Unpack it"),
    "a path out of a zip": (
        "a.zip",
        lambda p: zipped(p, "../../etc/a.tif"),
        "a path that leads out of it",
        "Pack it anew",
    ),
    "a zip with a password": ("a.zip", locked, "locked with a password", "Unpack it"),
    "no zip": ("a.zip", lambda p: p.write_bytes(b"no"), "cannot be unpacked", "again"),
    "a mosaic of nothing": (
        "a.vrt",
        lambda p: p.write_text(MOSAIC.format(' relativeToVRT="1"', "gone.tif")),
        "names 'gone.tif', which does not exist",
        "gdalbuildvrt",
    ),
    "a mosaic of a network": (
        "a.vrt",
        lambda p: p.write_text(MOSAIC.format("", "/vsicurl/http://example.com/a.tif")),
        "no file of this computer",
        "Download",
    ),
    "a mosaic of itself": (
        "a.vrt",
        lambda p: p.write_text(MOSAIC.format(' relativeToVRT="1"', "a.vrt")),
        "names itself",
        "gdalbuildvrt",
    ),
    "a mosaic cut short": (
        "a.vrt",
        lambda p: p.write_text("<VRTDataset"),
        "cannot be read as .vrt",
        "again",
    ),
    "another program's .DAT": (
        "a.DAT",
        lambda p: p.write_bytes(b"x" * 5000),
        "5000 bytes, ArduPilot's terrain has blocks of 2048",
        "APM/TERRAIN",
    ),
    "an .hgt in a zip, cut": (
        "N46E007.hgt.zip",
        lambda p: zipped(p, "N46E007.hgt"),
        "holds a tile of 7 bytes, an SRTM tile has 2884802 (3 arc-seconds), 12970802",
        "download it again",
    ),
}


@pytest.mark.parametrize("case", BAD, ids=str)
def test_bad_models_are_refused(tmp_path, case):
    """Scenario, key, file, reason and cure are in one message, and nothing else is raised."""
    name, make, reason, cure = BAD[case]
    make(tmp_path / name)
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(SCENARIO.format(source=name))
    with pytest.raises(TerrainError) as caught:
        load_ground(load_scenario(scenario))
    message = str(caught.value)
    assert message.startswith(f"{scenario}: terrain.source: {tmp_path / name}")
    assert reason in message
    assert cure in message
    assert message.endswith((".", "…"))


def test_heights_above_an_old_ellipsoid_are_refused(tmp_path):
    """Clarke's of NAD27 lies elsewhere than that of WGS-84, from which the geoid is measured."""
    tif(tmp_path / "a.tif", crs="EPSG:4267", west=-84.4, north=36.7)
    with pytest.raises(TerrainError, match=r"Clarke 1866, for which no geoid .* EPSG:4979"):
        load_dem(
            tmp_path / "a.tif",
            center=None,
            size_m=(200.0, 200.0),
            declared=DeclaredHeights("", "ellipsoid"),
        )


@pytest.mark.parametrize("name", ["a.zip", "a.tif.gz"])
def test_archives_that_unpack_without_end_are_refused(tmp_path, monkeypatch, name):
    """What is packed is measured before GDAL unpacks it; 4 GiB is the bound, 1 MB here."""
    monkeypatch.setattr(packed, "_LARGEST_BYTES", 10**6)
    path, content = tmp_path / name, bytes(3 * 10**6)
    if name.endswith("zip"):
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("a.tif", content)
    else:
        path.write_bytes(gzip.compress(content))
    assert path.stat().st_size < 10_000
    with pytest.raises(TerrainError, match=r"holds more than .* unpacked\. Unpack it where"):
        load_dem(path, center=None, size_m=(200.0, 200.0))


def test_names_with_odd_characters_are_read(tmp_path):
    """Blanks, braces and folders in an archive; what macOS puts beside is passed over."""
    tif(tmp_path / "plain.tif")
    path = tmp_path / "tile #1 {a}.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.write(tmp_path / "plain.tif", "sub folder/x y.TIF")
        archive.writestr("__MACOSX/sub folder/._x y.TIF", b"nothing")
    one, other = (
        load_dem(p, center=None, size_m=(200.0, 200.0)) for p in (path, tmp_path / "plain.tif")
    )
    assert one.surface.coefficients.tobytes() == other.surface.coefficients.tobytes()
