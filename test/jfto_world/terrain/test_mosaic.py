"""Areas that lie on several elevation models."""

from __future__ import annotations

import numpy as np
import pytest
import rasterio
from affine import Affine
from pyproj import Transformer

from jfto_msgs_py.errors import TerrainError
from jfto_world.terrain import load_dem

LAT, LON = 46.2, 7.6
SIZE = (900.0, 700.0)


def hill(lat, lon):
    """Smooth ground at a latitude and longitude, m above sea level."""
    north, east = (lat - LAT) * 111_200, (lon - LON) * 77_000
    return 1500 + 0.3 * east - 0.2 * north + 60 * np.sin(east / 250) * np.cos(north / 300)


def write(path, corner, cell, shape, *, crs="EPSG:4326", above=0.0, height=hill, **profile):
    """A raster of the hill; `corner` is its north-western one and `cell` in the CRS."""
    to_degrees = Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
    row, column = np.mgrid[0 : shape[0], 0 : shape[1]] + 0.5
    lon, lat = to_degrees.transform(corner[0] + column * cell, corner[1] - row * cell)
    options = {"driver": "GTiff", "count": 1, "dtype": "float64", "crs": crs} | profile
    options |= {"height": shape[0], "width": shape[1]}
    options["transform"] = Affine(cell, 0, corner[0], 0, -cell, corner[1])
    heights = np.asarray(height(lat, lon) + above)
    with rasterio.open(path, "w", **options) as dataset:
        dataset.write(heights, 1)
    return path


def samples(dem):
    """Heights above sea level at places all over the area, and those places."""
    x, y = np.meshgrid(np.linspace(-440, 440, 45), np.linspace(-340, 340, 35))
    lat, lon, alt = dem.to_geodetic(np.stack([x, y, dem.height(x, y)], axis=-1))
    return lat, lon, alt


def test_an_area_across_a_border_equals_the_merged_tile(tmp_path):
    """Two tiles that meet in the middle of the area, and a .vrt of them, give the same ground."""
    cell = 1 / 3600
    corner = LON - 200 * cell, LAT + 150 * cell
    whole = write(tmp_path / "whole.tif", corner, cell, (300, 400))
    folder = tmp_path / "tiles"
    folder.mkdir()
    write(folder / "west.tif", corner, cell, (300, 200))
    write(folder / "east.tif", (LON, corner[1]), cell, (300, 200))
    sources = "".join(
        f'<SimpleSource><SourceFilename relativeToVRT="1">tiles/{name}.tif</SourceFilename>'
        '<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="200" ySize="300"/>'
        f'<DstRect xOff="{off}" yOff="0" xSize="200" ySize="300"/></SimpleSource>'
        for name, off in (("west", 0), ("east", 200))
    )
    mosaic = tmp_path / "all.vrt"
    mosaic.write_text(
        f'<VRTDataset rasterXSize="400" rasterYSize="300"><SRS>EPSG:4326</SRS><GeoTransform>'
        f"{corner[0]!r}, {cell!r}, 0, {corner[1]!r}, 0, {-cell!r}</GeoTransform>"
        f'<VRTRasterBand dataType="Float64" band="1">{sources}</VRTRasterBand></VRTDataset>'
    )
    merged = load_dem(whole, center=(LAT, LON), size_m=SIZE)
    for source in (folder, mosaic):
        dem = load_dem(source, center=(LAT, LON), size_m=SIZE)
        assert np.abs(dem.surface.coefficients - merged.surface.coefficients).max() < 1e-6
        assert dem.origin.alt_m == pytest.approx(merged.origin.alt_m, abs=1e-9)
    assert np.abs(samples(merged)[2] - hill(*samples(merged)[:2])).max() < 0.01


def test_fine_tiles_lie_upon_coarse_ones(tmp_path):
    """Of 30 m and 1 m models the fine one is taken where it is, and the difference is named."""
    write(tmp_path / "coarse.tif", (LON - 0.03, LAT + 0.03), 1 / 3600, (216, 216))
    fine = (391_900.0, 5_117_500.0)
    write(tmp_path / "fine.tif", fine, 1.0, (300, 300), crs="EPSG:32632", above=2.0)
    dem = load_dem(tmp_path, center=(LAT, LON), size_m=SIZE)
    lat, lon, alt = samples(dem)
    off = alt - hill(lat, lon)
    east, north = Transformer.from_crs("EPSG:4326", "EPSG:32632", always_xy=True).transform(
        lon, lat
    )
    inner = (np.abs(east - 392_050) < 130) & (np.abs(north - 5_117_350) < 130)
    outer = (np.abs(east - 392_050) > 180) | (np.abs(north - 5_117_350) > 180)
    assert inner.sum() > 50
    assert np.abs(off[inner] - 2.0).max() < 0.05
    assert np.abs(off[outer]).max() < 0.6
    assert "in 2 grids" in dem.description
    assert any("overlap and differ by up to 2." in note for note in dem.notes)


@pytest.mark.parametrize("gap_m", [0, 25])
def test_models_of_neighbouring_utm_zones_meet_at_their_border(tmp_path, gap_m):
    """At 6° E one model is in zone 31, the next in 32; a strip between them is named."""
    lat, lon = 46.2, 6.0

    def ground(lat_, lon_):
        return hill(lat_, lon_ + LON - lon)

    for zone, side in ((31, -1), (32, 1)):
        crs = f"EPSG:326{zone}"
        to_map = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
        x, y = to_map.transform(lon, lat)
        corner = (x - 1500 - gap_m if side < 0 else x - 50 + gap_m, y + 1200)
        width = 155 if side < 0 and not gap_m else 150
        write(tmp_path / f"{zone}.tif", corner, 10.0, (240, width), crs=crs, height=ground)
    if gap_m:
        with pytest.raises(
            TerrainError, match=r"covers only .*the first gap is at 46\.\d+, [56]\..* Add the tile"
        ):
            load_dem(tmp_path, center=(lat, lon), size_m=SIZE)
        return
    dem = load_dem(tmp_path, center=(lat, lon), size_m=SIZE)
    lat_, lon_, alt = samples(dem)
    assert np.abs(alt - ground(lat_, lon_)).max() < 0.05
    assert "zone 31N" in dem.description
    assert "zone 32N" in dem.description


def test_what_one_tile_lacks_another_gives(tmp_path):
    """A hole in the fine model is filled from the coarse one; alone its place is named."""
    crs, fine = "EPSG:32632", (391_400.0, 5_117_900.0)
    options = {"crs": crs, "nodata": -9999.0}

    def holed(lat, lon):
        heights = hill(lat, lon)
        heights[450:470, 600:620] = -9999.0
        return heights

    write(tmp_path / "fine.tif", fine, 1.0, (1200, 1200), height=holed, **options)
    with pytest.raises(TerrainError, match=r"without a height, first at 46\.\d+, 7\.\d+") as alone:
        load_dem(tmp_path / "fine.tif", center=(LAT, LON), size_m=(600.0, 600.0), margin_m=100.0)
    # No height there is 0, so that counting these would mend nothing.
    assert "zero_is_void" not in str(alone.value)
    write(tmp_path / "beside.tif", (391_400.0, 5_116_700.0), 1.0, (20, 1200), crs=crs)
    with pytest.raises(TerrainError, match="Add the tile that lies there") as several:
        load_dem(tmp_path, center=(LAT, LON), size_m=(600.0, 600.0), margin_m=100.0)
    assert "zero_is_void" not in str(several.value)
    write(tmp_path / "coarse.tif", (LON - 0.03, LAT + 0.03), 1 / 3600, (216, 216))
    dem = load_dem(tmp_path, center=(LAT, LON), size_m=(600.0, 600.0), margin_m=100.0)
    x, y = np.meshgrid(np.linspace(-390, 390, 200), np.linspace(-390, 390, 200))
    lat, lon, alt = dem.to_geodetic(np.stack([x, y, dem.height(x, y)], axis=-1))
    assert np.abs(alt - hill(lat, lon)).max() < 0.3


def test_tiles_that_lie_elsewhere_do_no_harm(tmp_path):
    """Of a folder only what lies under the area counts, for its cells too."""
    write(tmp_path / "here.tif", (LON - 0.03, LAT + 0.03), 1 / 3600, (216, 216))
    write(tmp_path / "far.tif", (391_900.0, 5_217_500.0), 1.0, (50, 50), crs="EPSG:32632")
    alone = load_dem(tmp_path / "here.tif", center=(LAT, LON), size_m=SIZE)
    dem = load_dem(tmp_path, center=(LAT, LON), size_m=SIZE)
    assert dem.surface.coefficients.tobytes() == alone.surface.coefficients.tobytes()


def test_a_rotated_grid_lies_where_its_transform_says(tmp_path):
    """Rows that run obliquely, as cameras' mosaics have them, and rows that run northwards."""
    turned, cell = np.radians(30), 10.0
    across, along = cell * np.cos(turned), cell * np.sin(turned)
    oblique = Affine(across, along, 391_000, along, -across, 5_117_000)
    row, column = np.mgrid[0:300, 0:300] + 0.5
    for name, place in (("oblique", oblique), ("up", Affine(10, 0, 390_500, 0, 10, 5_116_000))):
        east = place.a * column + place.b * row + place.c
        north = place.d * column + place.e * row + place.f
        lon, lat = Transformer.from_crs("EPSG:32632", "EPSG:4326", always_xy=True).transform(
            east, north
        )
        options = {"driver": "GTiff", "count": 1, "dtype": "float64", "crs": "EPSG:32632"}
        options |= {"height": 300, "width": 300, "transform": place}
        with rasterio.open(tmp_path / f"{name}.tif", "w", **options) as dataset:
            dataset.write(hill(lat, lon), 1)
        dem = load_dem(tmp_path / f"{name}.tif", center=None, size_m=SIZE)
        lat, lon, alt = samples(dem)
        assert np.abs(alt - hill(lat, lon)).max() < 0.05, name


@pytest.mark.parametrize(("crs", "lat"), [("EPSG:3413", 89.999), ("EPSG:3031", -89.9995)])
def test_at_the_poles_longitudes_turn_and_the_ground_does_not(tmp_path, crs, lat):
    """An area that holds the pole, in a polar map, against the same ground in its metres."""
    cell, size = 10.0, 240
    row, column = np.mgrid[0:size, 0:size] + 0.5
    east, north = (column - size / 2) * cell, (size / 2 - row) * cell
    options = {"driver": "GTiff", "count": 1, "dtype": "float64", "crs": crs}
    options |= {"height": size, "width": size}
    options["transform"] = Affine(cell, 0, -size / 2 * cell, 0, -cell, size / 2 * cell)
    heights = 300 + 0.2 * east - 0.1 * north
    with rasterio.open(tmp_path / "pole.tif", "w", **options) as dataset:
        dataset.write(heights, 1)
    dem = load_dem(tmp_path / "pole.tif", center=(lat, 20.0), size_m=(400.0, 400.0))
    lat_, lon_, alt = samples(dem)
    x, y = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(lon_, lat_)
    assert np.abs(alt - (300 + 0.2 * x - 0.1 * y)).max() < 0.01


def test_a_mosaic_follows_no_other_off_this_computer(tmp_path):
    """A mosaic of a mosaic is looked into, and one that comes back to the first is refused."""
    inner, outer = tmp_path / "inner.vrt", tmp_path / "outer.vrt"
    text = (
        '<VRTDataset rasterXSize="9" rasterYSize="9"><SRS>EPSG:4326</SRS>'
        "<GeoTransform>7,0.1,0,46,0,-0.1</GeoTransform>"
        '<VRTRasterBand dataType="Int16" band="1"><SimpleSource><SourceFilename '
        'relativeToVRT="{}">{}</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>'
    )
    outer.write_text(text.format(1, "inner.vrt"))
    for relative, name, words in (
        (0, "/vsis3/bucket/a.tif", "inner.vrt names '/vsis3/bucket/a.tif', which is no file"),
        (1, "outer.vrt", "names itself"),
    ):
        inner.write_text(text.format(relative, name))
        with pytest.raises(TerrainError, match=words):
            load_dem(outer, center=(46.0, 7.0), size_m=SIZE)


def test_a_small_fine_model_in_a_wide_area_is_not_passed_over(tmp_path):
    """Of 50 m it lies between the places at which coverage is probed."""

    def level(lat, lon):
        return 1500.0 + 0 * lat

    write(tmp_path / "coarse.tif", (LON - 0.3, LAT + 0.2), 1 / 1200, (480, 720), height=level)
    write(tmp_path / "fine.tif", (LON - 0.0003, LAT + 0.0003), 0.00001, (60, 60), height=level)
    dem = load_dem(tmp_path, center=(LAT + 0.02, LON + 0.01), size_m=(15_000.0, 15_000.0))
    assert "in 2 grids" in dem.description
