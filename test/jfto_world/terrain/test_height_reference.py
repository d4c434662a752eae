"""Units and datums of heights, old horizontal datums, the date line, tiles and packed files."""

from __future__ import annotations

import gzip
import zipfile
from pathlib import Path

import numpy as np
import pytest
import rasterio
from affine import Affine

from jfto_msgs_py.errors import TerrainError
from jfto_world.terrain import DeclaredHeights, load_dem

CASES = Path(__file__).parents[2] / "data/cases"
STATE_PLANE = CASES / "09a-stateplane-ft.tif"
SIZE = (300.0, 300.0)


def write(path, *, crs="EPSG:4326", west=7.5, north=46.3, cell=1 / 1200, unit=None, **profile):
    """A GeoTIFF of 240 × 240 cells, 1000 m at its western edge, 2 higher per column."""
    heights = np.tile(1000 + 2 * np.arange(240, dtype=np.float32), (240, 1))
    heights = profile.pop("heights", heights)
    options = {"driver": "GTiff", "count": 1, "dtype": heights.dtype, "crs": crs} | profile
    options |= {"height": heights.shape[0], "width": heights.shape[1]}
    options["transform"] = Affine(cell, 0, west, 0, -cell, north)
    with rasterio.open(path, "w", **options) as dataset:
        dataset.write(heights, 1)
        if unit:
            dataset.units = (unit,)
    return path


def test_a_map_in_feet_needs_a_word_on_its_heights():
    """State plane in US survey feet without a vertical system: refused, and declarable."""
    with pytest.raises(TerrainError, match=r"US survey foot.*Declare terrain\.vertical_unit"):
        load_dem(STATE_PLANE, center=None, size_m=SIZE)
    feet = load_dem(STATE_PLANE, center=None, size_m=SIZE, declared=DeclaredHeights("us_ft"))
    assert feet.origin.alt_m == pytest.approx(2000.0, abs=0.1)
    metres = load_dem(STATE_PLANE, center=None, size_m=SIZE, declared=DeclaredHeights("m"))
    assert metres.origin.alt_m == pytest.approx(6561.7, abs=0.1)


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("dm", 0.1), ("cm", 0.01), ("Metre", 1), ("foot", 0.3048), ("US survey foot", 1200 / 3937)],
)
def test_known_units_become_metres(tmp_path, unit, metres):
    """Whatever the band names is honoured."""
    one = load_dem(write(tmp_path / "a.tif"), center=None, size_m=SIZE)
    other = load_dem(write(tmp_path / "b.tif", unit=unit), center=None, size_m=SIZE)
    assert other.origin.alt_m == pytest.approx(one.origin.alt_m * metres, rel=1e-6)


def test_decimetres_of_the_case():
    """400 m, not 4000."""
    dem = load_dem(CASES / "09b-unit-dm.tif", center=None, size_m=SIZE)
    assert dem.origin.alt_m == pytest.approx(400.0, abs=0.1)


@pytest.mark.parametrize("unit", ["fathom", "yards", "xyz"])
def test_an_unknown_unit_is_refused_and_declarable(tmp_path, unit):
    """Never taken for metres."""
    path = write(tmp_path / "u.tif", unit=unit)
    with pytest.raises(TerrainError, match=rf"'{unit}', a unit that is not known. Declare"):
        load_dem(path, center=None, size_m=SIZE)
    assert load_dem(path, center=None, size_m=SIZE, declared=DeclaredHeights("m"))


def test_contradictions_are_refused(tmp_path):
    """The band's unit against the vertical system's or the declared one; datums likewise."""
    feet = write(tmp_path / "f.tif", unit="ft")
    with pytest.raises(TerrainError, match="contradicting units"):
        load_dem(feet, center=None, size_m=SIZE, declared=DeclaredHeights("m"))
    both = write(tmp_path / "b.tif", crs="EPSG:4326+6360", unit="m")
    with pytest.raises(TerrainError, match="contradicting units"):
        load_dem(both, center=None, size_m=SIZE)
    geoid = write(tmp_path / "g.tif", crs="EPSG:4326+3855")
    for datum in ("ellipsoid", "EGM96"):
        with pytest.raises(TerrainError, match=r"EGM2008.*vertical_datum declares"):
            load_dem(geoid, center=None, size_m=SIZE, declared=DeclaredHeights("", datum))
    for datum in ("EGM2008", "sea_level", ""):
        dem = load_dem(geoid, center=None, size_m=SIZE, declared=DeclaredHeights("", datum))
        assert dem.origin.alt_m == pytest.approx(1239, abs=0.5)


@pytest.mark.parametrize("datum", ["ellipsoid", "EGM96", "EGM2008", "sea_level"])
def test_a_datum_that_the_file_does_not_name_is_declared(tmp_path, datum):
    """Heights above an ellipsoid are brought to sea level, and a line names what was said."""
    declared = DeclaredHeights("", datum)
    dem = load_dem(write(tmp_path / "d.tif"), center=None, size_m=SIZE, declared=declared)
    geoid_m = 51.9 if datum == "ellipsoid" else 0.0
    assert dem.origin.alt_m == pytest.approx(1239 - geoid_m, abs=0.5)
    assert "as declared" in dem.description + " ".join(dem.notes)
    with pytest.raises(TerrainError, match="Leave out"):
        load_dem("jacksboro", center=None, size_m=SIZE, declared=declared)


def test_depths_are_refused(tmp_path):
    """A vertical axis that points down."""
    with pytest.raises(TerrainError, match="holds depths"):
        load_dem(write(tmp_path / "d.tif", crs="EPSG:4326+5831"), center=None, size_m=SIZE)


@pytest.mark.parametrize("center", [(-17.0, 179.9995), (-17.0, 180.0), (-17.0, -179.9995), None])
def test_the_date_line_runs_through(center):
    """A raster across it covers areas on both sides, and on it."""
    dem = load_dem(CASES / "10a-antimeridian.tif", center=center, size_m=(1000.0, 1000.0))
    assert -180 <= dem.origin.lon_deg <= 180
    assert dem.origin.alt_m == pytest.approx(300, abs=3)
    east = dem.to_enu(-17.0, -179.999, dem.origin.alt_m) - dem.to_enu(-17.0, 179.999, 0.0)
    assert east[0] == pytest.approx(213, abs=1)


@pytest.mark.parametrize("west", [-180.1, 179.9, 539.9])
def test_longitudes_of_any_turn(tmp_path, west):
    """Files count longitudes from -180, from 0, or beyond."""
    path = write(tmp_path / "w.tif", west=west, north=-16.9)
    dem = load_dem(path, center=(-17.0, 180.0), size_m=SIZE)
    assert dem.origin.alt_m == pytest.approx(1000 + 2 * 119.5, abs=0.5)
    with pytest.raises(TerrainError, match="covers only 0 %"):
        load_dem(path, center=(-17.0, 170.0), size_m=SIZE)


def test_the_date_line_runs_through_a_web_map(tmp_path):
    """Eastings of a cylinder projection go on beyond the end of the map."""
    path = write(
        tmp_path / "m.tif", crs="EPSG:3857", west=20_037_000.0, north=-1_900_000.0, cell=10
    )
    dem = load_dem(path, center=None, size_m=(1000.0, 1000.0))
    assert dem.origin.lon_deg < -179
    assert dem.origin.alt_m == pytest.approx(1239, abs=0.5)


def test_a_local_system_and_an_own_shift(tmp_path):
    """A site's own grid lies nowhere; a shift that the file itself gives is used."""
    path = write(
        tmp_path / "l.tif", crs='LOCAL_CS["site",UNIT["metre",1]]', west=0, north=0, cell=9
    )
    with pytest.raises(TerrainError, match="local system"):
        load_dem(path, center=None, size_m=SIZE)
    shifted = "+proj=longlat +ellps=krass +towgs84=15.8,-154.4,-82.3 +no_defs"
    path = write(tmp_path / "k.tif", crs=shifted, west=103.9, north=33.0)
    dem = load_dem(path, center=None, size_m=SIZE)
    assert dem.origin.lon_deg - 104.0 == pytest.approx(0.00024, abs=0.0001)


@pytest.mark.parametrize(("code", "datum"), [(4610, "Xian 1980"), (4214, "Beijing 1954")])
def test_old_datums_without_a_shift_are_refused(tmp_path, code, datum):
    """PROJ would take their degrees for WGS-84, unsaid."""
    path = write(tmp_path / "o.tif", crs=f"EPSG:{code}", west=103.9, north=33.0)
    with pytest.raises(TerrainError, match=rf"datum {datum}.*Convert it"):
        load_dem(path, center=(32.9, 104.0), size_m=SIZE)


@pytest.mark.parametrize(
    ("code", "west", "north", "words"),
    [
        (4490, 103.9, 33.0, "China 2000 taken for WGS-84"),
        (4267, -84.4, 36.6, "placed to within"),
        (4258, 7.5, 46.3, ""),
    ],
)
def test_how_well_places_are_known_is_said(tmp_path, code, west, north, words):
    """Modern frames agree with WGS-84; old ones are shifted, to some metres."""
    path = write(tmp_path / "m.tif", crs=f"EPSG:{code}", west=west, north=north)
    description = load_dem(path, center=None, size_m=SIZE).description
    assert words in description
    if not words:
        assert "placed" not in description


def hgt(folder, name, east=0):
    """An SRTM tile whose heights go on from one tile to the next."""
    columns = np.arange(1201) + 1200 * east
    heights = np.tile(500 + columns // 4, (1201, 1)).astype(">i2")
    (folder / name).write_bytes(heights.tobytes())
    return folder / name


def test_neighbouring_tiles_are_one_ground(tmp_path):
    """A folder of tiles covers an area across their seam, without a step there."""
    hgt(tmp_path, "N46E007.hgt")
    with pytest.raises(TerrainError, match="covers only"):
        load_dem(tmp_path / "N46E007.hgt", center=(46.5, 8.0), size_m=SIZE)
    hgt(tmp_path, "N46E008.hgt", east=1)
    (tmp_path / "readme.txt").write_text("not a tile")
    dem = load_dem(tmp_path, center=(46.5, 8.0), size_m=(2000.0, 2000.0))
    assert "2 tiles" in dem.description
    x = np.linspace(-900, 900, 50)
    slope = np.diff(dem.height(x, 0 * x))
    assert slope.min() > -0.5
    assert dem.origin.alt_m == pytest.approx(500 + 1200 / 4, abs=1)


def test_tiles_that_do_not_fit_are_refused(tmp_path):
    """Another datum; heights that are 100 m off where two overlap."""
    for name, options, words in (
        ("datum", {"crs": "EPSG:4326+3855"}, "another height datum"),
        (
            "off",
            {"heights": np.full((240, 240), 1139.0, dtype=np.float32)},
            "differ by 244 m there",
        ),
    ):
        folder = tmp_path / name
        folder.mkdir()
        write(folder / "a.tif")
        write(folder / "b.tif", **{"west": 7.6} | options)
        with pytest.raises(TerrainError, match=words):
            load_dem(folder, center=(46.2, 7.66), size_m=SIZE)


def test_packed_and_mosaic_files(tmp_path):
    """.zip, .gz and .vrt give the ground of what they hold."""
    tile = hgt(tmp_path, "N46E007.hgt")
    plain = load_dem(tile, center=(46.5, 7.5), size_m=SIZE)
    with zipfile.ZipFile(tmp_path / "N46E007.SRTMGL3.hgt.zip", "w") as archive:
        archive.write(tile, "N46E007.hgt")
    (tmp_path / "N46E007.hgt.gz").write_bytes(gzip.compress(tile.read_bytes()))
    source = f'<SimpleSource><SourceFilename relativeToVRT="1">{tile.name}</SourceFilename>'
    source += "<SourceBand>1</SourceBand></SimpleSource>"
    (tmp_path / "all.vrt").write_text(
        '<VRTDataset rasterXSize="1201" rasterYSize="1201"><SRS>EPSG:4326</SRS><GeoTransform>'
        f"{7 - 1 / 2400}, {1 / 1200}, 0, {47 + 1 / 2400}, 0, {-1 / 1200}</GeoTransform>"
        f'<VRTRasterBand dataType="Int16" band="1">{source}</VRTRasterBand></VRTDataset>'
    )
    for name in ("N46E007.SRTMGL3.hgt.zip", "N46E007.hgt.gz", "all.vrt"):
        dem = load_dem(tmp_path / name, center=(46.5, 7.5), size_m=SIZE)
        assert dem.origin.alt_m == pytest.approx(plain.origin.alt_m, abs=1e-6), name


def test_files_that_are_no_models_are_told(tmp_path):
    """Point clouds, archives of many or of none."""
    (tmp_path / "cloud.laz").write_bytes(b"LASF")
    with pytest.raises(TerrainError, match=r"a point cloud: make a grid"):
        load_dem(tmp_path / "cloud.laz", center=None, size_m=SIZE)
    with zipfile.ZipFile(tmp_path / "two.zip", "w") as archive:
        archive.writestr("a.tif", b"x")
        archive.writestr("b.tif", b"x")
    with pytest.raises(TerrainError, match="holds 2 elevation models"):
        load_dem(tmp_path / "two.zip", center=None, size_m=SIZE)
    (tmp_path / "no.zip").write_bytes(b"no")
    with pytest.raises(TerrainError, match="cannot be unpacked"):
        load_dem(tmp_path / "no.zip", center=None, size_m=SIZE)
