from pathlib import Path

import numpy as np
import pytest
import rasterio
from affine import Affine
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import TerrainError
from jfto_world.terrain import load_dem

ASC = Path(__file__).parents[2] / "data" / "terrain" / "front_range_srtmgl3.asc"
ASC_CENTER = (40.15, -105.50)


def write_tif(path, heights, *, crs="EPSG:4326", west=-105.6, north=40.3, cell=1 / 1200, **profile):
    """A GeoTIFF of `heights`; cell in units of the CRS."""
    bands = np.atleast_3d(np.asarray(heights).T).T
    count, rows, columns = bands.shape
    options = {"driver": "GTiff", "height": rows, "width": columns, "count": count}
    options |= {
        "dtype": bands.dtype,
        "crs": crs,
        "transform": Affine(cell, 0, west, 0, -cell, north),
    }
    with rasterio.open(path, "w", **(options | profile)) as dataset:
        dataset.write(bands)
    return path


def hills(rows=240, columns=240):
    """Smooth made-up heights of 1000 ± 100 m."""
    y, x = np.mgrid[0:rows, 0:columns]
    return (1000 + 100 * np.sin(x / 15) * np.cos(y / 20)).astype(np.float32)


def test_esri_ascii_heights_come_back_at_their_cells():
    """At the centres of the file's cells the ground is within 10 cm of the file's heights."""
    dem = load_dem(ASC, center=ASC_CENTER, size_m=(4000, 3000))
    with rasterio.open(ASC) as dataset:
        heights = dataset.read(1).astype(float)
        row, column = np.mgrid[0 : dataset.height, 0 : dataset.width]
        lon, lat = dataset.xy(row.ravel(), column.ravel())
    lon, lat = np.reshape(lon, row.shape), np.reshape(lat, row.shape)
    place = dem.to_enu(lat, lon, heights)
    inside = (np.abs(place[..., 0]) < 2000) & (np.abs(place[..., 1]) < 1500)
    assert inside.sum() > 1500
    expected = place[..., 2][inside]
    found = dem.height(place[..., 0][inside], place[..., 1][inside])
    assert np.abs(found - expected).max() < 0.1


def test_origin_lies_on_the_ground_at_the_centre():
    """Z is 0 at the origin, whose altitude is the ground's there; z rises with altitude."""
    dem = load_dem(ASC, center=ASC_CENTER, size_m=(1000, 1000))
    assert (dem.origin.lat_deg, dem.origin.lon_deg) == ASC_CENTER
    assert 2300 < dem.origin.alt_m < 3300
    assert dem.height(0.0, 0.0) == pytest.approx(0.0, abs=0.02)
    assert "mean sea level" in dem.height_datum
    assert str(ASC) in dem.description


def test_built_in_tile_is_north_up():
    """The 1076 m summit of the tile lies in its south, at 36.485 N, 84.231 W."""
    dem = load_dem("jacksboro", center=(36.485, -84.2308), size_m=(2000, 2000))
    x, y, z = dem.grid()
    row, column = np.unravel_index(np.argmax(z), z.shape)
    assert dem.origin.alt_m + z.max() == pytest.approx(1076, abs=3)
    assert abs(x[column]) < 60
    assert abs(y[row]) < 60


def test_centre_defaults_to_the_middle_of_the_raster():
    """Without a centre the middle of the tile is taken."""
    dem = load_dem("jacksboro", center=None, size_m=(500, 500))
    assert (dem.origin.lat_deg, dem.origin.lon_deg) == pytest.approx(
        (36.58958, -84.24583), abs=1e-4
    )


@pytest.mark.parametrize(("samples", "name"), [(1201, "N40W106.hgt"), (3601, "s41e010.hgt")])
def test_srtm_tiles_of_both_sizes(tmp_path, samples, name):
    """A .hgt is big-endian, placed by its name, its first sample at the north-west corner."""
    south = 40 if name[0] == "N" else -41
    west = -106 if "W" in name else 10
    lat = south + 1 - np.arange(samples)[:, None] / (samples - 1)
    lon = west + np.arange(samples)[None, :] / (samples - 1)
    heights = (2000 + 1000 * (lat - south) + 500 * (lon - west)).round()
    heights[0, 0] = -32768
    heights.astype(">i2").tofile(tmp_path / name)
    center = (south + 0.25, west + 0.75)
    dem = load_dem(tmp_path / name, center=center, size_m=(1000, 1000))
    assert dem.origin.alt_m == pytest.approx(2000 + 250 + 375, abs=1.0)
    assert "EGM96" in dem.height_datum
    place = dem.to_enu(south + 0.253, west + 0.753, 0.0)
    assert dem.height(*place[:2]) + dem.origin.alt_m == pytest.approx(2629.5, abs=1.0)


def test_one_ground_in_two_coordinate_systems(tmp_path):
    """A raster in UTM gives the same ground as the same hill in degrees."""
    from pyproj import Transformer

    def hill(lat, lon):
        return 1500 + 300 * np.exp(-(((lat - 40.1) / 0.01) ** 2) - ((lon + 105.5) / 0.012) ** 2)

    row, column = np.mgrid[0:240, 0:240]
    geographic = hill(40.2 - (row + 0.5) / 1200, -105.6 + (column + 0.5) / 1200)
    first = write_tif(tmp_path / "degrees.tif", geographic, north=40.2)
    to_degrees = Transformer.from_crs("EPSG:32613", "EPSG:4326", always_xy=True)
    row, column = np.mgrid[0:300, 0:300]
    lon, lat = to_degrees.transform(450_000 + (column + 0.5) * 50, 4_447_000 - (row + 0.5) * 50)
    second = write_tif(
        tmp_path / "utm.tif", hill(lat, lon), crs="EPSG:32613", west=450e3, north=4_447_000, cell=50
    )
    one, two = (
        load_dem(path, center=(40.1, -105.5), size_m=(3000, 3000)) for path in (first, second)
    )
    x, y = np.meshgrid(np.linspace(-1900, 1900, 60), np.linspace(-1900, 1900, 60))
    assert np.abs(one.height(x, y) - two.height(x, y)).max() < 0.3
    assert np.ptp(one.height(x, y)) > 250


@pytest.mark.slow
@settings(deadline=None, derandomize=True, max_examples=15)
@given(st.floats(36.50, 36.68), st.floats(-84.37, -84.12), st.floats(200, 2500))
def test_ground_does_not_depend_on_how_it_is_cut(lat, lon, size):
    """Two cuts of one tile about different centres agree on the altitude of a place to 0.3 m."""
    one = load_dem("jacksboro", center=(lat, lon), size_m=(size, size))
    two = load_dem("jacksboro", center=(lat + 0.002, lon - 0.002), size_m=(size, size))
    x, y = np.meshgrid(np.linspace(-size / 2, size / 2, 9), np.linspace(-size / 2, size / 2, 9))
    place = np.stack([x, y, one.height(x, y)], axis=-1)
    lat_, lon_, alt = one.to_geodetic(place)
    there = two.to_enu(lat_, lon_, alt)
    assert np.abs(two.height(there[..., 0], there[..., 1]) - there[..., 2]).max() < 0.3


def test_heights_in_feet_become_metres(tmp_path):
    """A band in feet, or a vertical datum in feet, is converted."""
    path = write_tif(tmp_path / "feet.tif", hills() / 0.3048)
    with rasterio.open(path, "r+") as dataset:
        dataset.units = ("ft",)
    metres = load_dem(
        write_tif(tmp_path / "m.tif", hills()), center=(40.2, -105.5), size_m=(1000, 1000)
    )
    feet = load_dem(path, center=(40.2, -105.5), size_m=(1000, 1000))
    assert feet.origin.alt_m == pytest.approx(metres.origin.alt_m, abs=1e-3)
    compound = write_tif(tmp_path / "c.tif", hills() / (1200 / 3937), crs="EPSG:4326+6360")
    named = load_dem(compound, center=(40.2, -105.5), size_m=(1000, 1000))
    assert named.origin.alt_m == pytest.approx(metres.origin.alt_m, abs=1e-2)
    assert "NAVD88" in named.height_datum


def test_ellipsoidal_heights_are_told_apart(tmp_path):
    """A three-dimensional geographic CRS means heights above the ellipsoid: 13.5 m more there."""
    path = write_tif(tmp_path / "e.tif", hills(), crs="EPSG:4979")
    plain = write_tif(tmp_path / "p.tif", hills())
    dem, sea = (load_dem(p, center=(40.2, -105.5), size_m=(1000, 1000)) for p in (path, plain))
    assert dem.origin.alt_m - sea.origin.alt_m == pytest.approx(13.5, abs=0.5)
    assert "geoid EGM96" in dem.description
    assert "above the ellipsoid of WGS 84" in dem.notes[0]


def test_zeros_are_missing_data_unless_told_otherwise(tmp_path):
    """A zero in the area is refused by default and taken as sea level on request."""
    heights = hills()
    heights[110:131, 110:131] = 0
    path = write_tif(tmp_path / "sea.tif", heights)
    with pytest.raises(TerrainError, match="zero_is_void"):
        load_dem(path, center=(40.2, -105.5), size_m=(1000, 1000))
    dem = load_dem(path, center=(40.2, -105.5), size_m=(1000, 1000), zero_is_void=False)
    assert dem.origin.alt_m == pytest.approx(0.0, abs=0.1)


def test_voids_outside_of_the_area_do_no_harm(tmp_path):
    """Missing cells beyond the margin neither raise nor bend the ground."""
    heights = hills()
    whole = load_dem(
        write_tif(tmp_path / "a.tif", heights), center=(40.2, -105.5), size_m=(800, 800)
    )
    heights[:, :100] = np.nan
    holed = load_dem(
        write_tif(tmp_path / "b.tif", heights), center=(40.2, -105.5), size_m=(800, 800)
    )
    z = whole.grid()[2]
    assert holed.grid()[2] == pytest.approx(z, abs=0.1)


@pytest.mark.slow
def test_of_a_huge_raster_only_the_window_is_read(tmp_path):
    """A raster of 10^10 cells, sparse on disk, is opened and cut."""
    path = tmp_path / "huge.tif"
    options = {"driver": "GTiff", "height": 100_000, "width": 100_000, "count": 1}
    options |= {"dtype": "int16", "crs": "EPSG:32613", "tiled": True, "sparse_ok": True}
    options["transform"] = Affine(1, 0, 400_000, 0, -1, 4_500_000)
    with rasterio.open(path, "w", **options) as dataset:
        window = rasterio.windows.Window(51_200, 51_200, 2048, 2048)
        dataset.write(np.full((2048, 2048), 1234, np.int16), 1, window=window)
    from pyproj import Transformer

    to_degrees = Transformer.from_crs("EPSG:32613", "EPSG:4326", always_xy=True)
    lon, lat = to_degrees.transform(452_224, 4_447_776)
    dem = load_dem(path, center=(lat, lon), size_m=(500, 400), margin_m=100)
    assert dem.origin.alt_m == pytest.approx(1234, abs=1e-6)


@pytest.mark.slow
def test_fine_rasters_over_wide_areas_are_averaged_not_skipped(tmp_path):
    """Cells finer than the ground's own nodes are averaged over blocks: noise shrinks."""
    rng = np.random.default_rng(0)
    noisy = (1000 + 10 * rng.choice([-1.0, 1.0], size=(2300, 2300))).astype(np.float32)
    path = write_tif(
        tmp_path / "fine.tif", noisy, crs="EPSG:32613", west=450e3, north=4_447_000, cell=0.2
    )
    dem = load_dem(path, center=None, size_m=(400, 400), margin_m=0)
    _, _, z = dem.grid()
    assert z.shape == (1001, 1001)
    assert (z + dem.origin.alt_m).mean() == pytest.approx(1000, abs=0.1)
    assert (z + dem.origin.alt_m).std() < 8


def asc_text(rows="1 2\n3 4\n", **header):
    keys = {"ncols": 2, "nrows": 2, "xllcorner": -105.5, "yllcorner": 40.1, "cellsize": 0.01}
    return "".join(f"{key} {value}\n" for key, value in (keys | header).items()) + rows


BAD_FILES = {
    "missing": ("none.tif", None, "does not exist"),
    "folder": ("folder.tif", "folder", "not a file"),
    "suffix": ("dem.xyz", b"1 2 3", "no known DEM format"),
    "empty": ("dem.tif", b"", "empty"),
    "text as tif": ("dem.tif", b"not a tiff at all", "cannot be read as .tif"),
    "png as asc": ("dem.asc", b"\x89PNG\r\n\x1a\n" + bytes(64), "cannot be read as .asc"),
    "hgt name": ("tile.hgt", bytes(2884802), "no tile in its name"),
    "hgt cut short": ("N40W106.hgt", bytes(2884800), "cut short"),
    "hgt zipped": ("N40W106.hgt", b"PK\x03\x04" + bytes(500), "compressed"),
    "asc without header": ("dem.asc", b"1 2 3\n4 5 6\n", "cannot be read as .asc"),
    "asc bad header": ("dem.asc", asc_text(ncols="two").encode(), "cannot be read"),
    "asc projected, no prj": (
        "dem.asc",
        asc_text(xllcorner=450_000, yllcorner=4_440_000, cellsize=30).encode(),
        "names no coordinate system",
    ),
}


@pytest.mark.parametrize("case", BAD_FILES, ids=str)
def test_bad_files_are_refused_with_name_reason_and_cure(tmp_path, case):
    """Each bad file gives a TerrainError that names it, says why and ends with advice."""
    name, content, reason = BAD_FILES[case]
    path = tmp_path / name
    if content == "folder":
        path.mkdir()
    elif content is not None:
        path.write_bytes(content)
    with pytest.raises(TerrainError) as caught:
        load_dem(path, center=(40.1, -105.5), size_m=(100, 100), margin_m=0)
    assert str(path) in str(caught.value)
    assert reason in str(caught.value)
    assert str(caught.value).endswith((".", "…"))


def test_files_cut_short_are_refused(tmp_path):
    """A GeoTIFF and an Esri ASCII grid whose end is missing raise, and do not yield zeros."""
    tif = write_tif(tmp_path / "cut.tif", hills())
    tif.write_bytes(tif.read_bytes()[:60_000])
    asc = tmp_path / "cut.asc"
    asc.write_bytes(ASC.read_bytes()[:40_000])
    for path, center in ((tif, (40.11, -105.5)), (asc, (40.11, -105.5))):
        with pytest.raises(TerrainError, match=r"damaged|cannot be read"):
            load_dem(path, center=center, size_m=(500, 500), margin_m=100)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"nodata": -9999.0, "value": -9999.0}, "without a height"),
        ({"value": np.nan}, "without a height"),
        ({"value": np.inf}, "without a height"),
        ({"value": -9999.0}, "no ground on earth"),
        ({"value": 30_000.0}, "no ground on earth"),
        ({"value": 0.0}, "zero_is_void"),
    ],
)
def test_bad_heights_are_refused_with_their_place(tmp_path, change, reason):
    """Voids, infinities and absurd heights in the area raise and say where the first one is."""
    heights = hills()
    heights[120, 120] = change["value"]
    profile = {"nodata": change["nodata"]} if "nodata" in change else {}
    path = write_tif(tmp_path / "bad.tif", heights, **profile)
    with pytest.raises(TerrainError, match=reason) as caught:
        load_dem(path, center=(40.2, -105.5), size_m=(1000, 1000))
    assert "first at 40.19" in str(caught.value)
    assert str(path) in str(caught.value)


def test_images_and_unplaced_rasters_are_refused(tmp_path):
    """Three bands, complex values, no transform and no CRS are each told apart."""
    image = write_tif(tmp_path / "rgb.tif", np.zeros((3, 50, 50), np.uint8))
    complex_ = write_tif(tmp_path / "cpx.tif", np.zeros((50, 50), np.complex64))
    nowhere = write_tif(tmp_path / "crs.tif", hills(), crs=None)
    unplaced = tmp_path / "plain.tif"
    with pytest.warns(rasterio.errors.NotGeoreferencedWarning):
        write_tif(unplaced, hills(), crs=None, transform=Affine.identity())
    for path, reason in (
        (image, "3 bands"),
        (complex_, "not heights"),
        (nowhere, "names no coordinate system"),
        (unplaced, "not georeferenced"),
    ):
        with pytest.raises(TerrainError, match=reason):
            load_dem(path, center=(40.2, -105.5), size_m=(100, 100))


@pytest.mark.parametrize(
    ("wish", "reason"),
    [
        ({"center": (40.2, -105.561)}, "covers only"),
        ({"margin_m": 8000.0}, "margin of 8000 m"),
        ({"center": (10.0, 20.0)}, "covers only 0 %"),
        ({"center": (40.15, -105.5), "size_m": (20_000.0, 100.0)}, "covers only"),
        ({"center": (95.0, 0.0)}, "not a latitude"),
        ({"center": (np.nan, 0.0)}, "not a latitude"),
        ({"center": (-105.5, 40.15)}, "not a latitude"),
        ({"size_m": (0.0, 100.0)}, "size_m"),
        ({"size_m": (np.nan, 100.0)}, "size_m"),
        ({"size_m": (100.0, 1e9)}, "size_m"),
        ({"margin_m": -1.0}, "margin_m"),
    ],
)
def test_impossible_areas_are_refused(wish, reason):
    """An area off the tile, or of no size, raises and says what the tile holds."""
    wish = {"center": ASC_CENTER, "size_m": (1000.0, 1000.0)} | wish
    with pytest.raises(TerrainError, match=reason) as caught:
        load_dem(ASC, **wish)
    if "covers" in reason:
        assert "latitude 40.09" in str(caught.value)


def test_near_the_edge_of_a_raster_the_margin_shrinks_unless_asked_for():
    """Without margin_m the widest margin that the file holds is taken, and told."""
    near = (40.2, -105.5)
    dem = load_dem(ASC, center=near, size_m=(2000, 2000))
    assert 0 <= dem.half_extent_m[0] - 1000 < 500
    assert f"known {dem.half_extent_m[0] - 1000:.0f} m beyond" in dem.description
    wide = load_dem(ASC, center=ASC_CENTER, size_m=(2000, 2000))
    assert wide.half_extent_m == (1500, 1500)
    with pytest.raises(TerrainError, match="margin of 500 m"):
        load_dem(ASC, center=near, size_m=(2000, 2000), margin_m=500)


def test_loading_twice_gives_equal_bits():
    """The ground is a function of its inputs alone."""
    one, two = (load_dem(ASC, center=ASC_CENTER, size_m=(900, 700)) for _ in range(2))
    assert one.origin == two.origin
    assert one.surface.coefficients.tobytes() == two.surface.coefficients.tobytes()
