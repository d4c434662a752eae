"""ArduPilot's own terrain files against a writer that shares nothing with the reader."""

from __future__ import annotations

import gzip

import numpy as np
import pytest

from jfto_msgs_py.errors import TerrainError
from jfto_world.terrain import DeclaredHeights, load_dem
from jfto_world.terrain.autopilot_grid import open_autopilot_grids
from support.autopilot_terrain import write_degree

SIZE = (600.0, 400.0)


def slope(lat, lon):
    """Steep, and not a plane."""
    return 900 + 30_000 * (lat % 1) * (0.2 + lon % 1) + 200 * np.sin(lon * 500)


@pytest.mark.parametrize(("lat", "lon"), [(46, 7), (-34, 151), (-1, -78), (71, 179), (12, -180)])
def test_every_height_of_a_file_comes_back_where_it_was_written(tmp_path, lat, lon):
    """In each hemisphere, to the autopilot's own rounding of places (1 cm)."""
    path, points = write_degree(tmp_path, lat, lon, slope, rows=range(3), columns=range(2, 5))
    grid = open_autopilot_grids([path], str(path))
    # Beyond these the next block begins, whose points lie elsewhere.
    own = np.array(points).reshape(-1, 28, 32, 3)[:, :24, :28].reshape(-1, 3)
    found = grid.heights(own[:, 0], own[:, 1], 33, 100, False)(own[:, 0], own[:, 1])
    assert len(own) == 9 * 24 * 28
    assert np.abs(found - own[:, 2]).max() < 0.02


def test_the_ground_of_a_scenario(tmp_path):
    """A plane comes back everywhere, between points and over the seams of blocks, to 0.6 m."""

    def plane(lat, lon):
        return 500 + 2000 * (lat - 46) + 3000 * (lon - 7)

    path, _ = write_degree(tmp_path, 46, 7, plane, rows=range(3), columns=range(3))
    lat, lon = 46 + 24 * 100 / 111_319, 7 + 28 * 100 / 111_319 / np.cos(np.radians(46))
    packed = tmp_path / "N46E007.DAT.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    for file in (path, packed):
        dem = load_dem(file, center=(lat, lon), size_m=SIZE)
        x, y = np.meshgrid(np.linspace(-300, 300, 31), np.linspace(-200, 200, 21))
        place = np.stack([x, y, dem.height(x, y)], axis=-1)
        lat_, lon_, alt = dem.to_geodetic(place)
        assert np.abs(alt - plane(lat_, lon_)).max() < 0.6
        assert "EGM96" in dem.height_datum
    with pytest.raises(TerrainError, match=r"covers only .* first gap is at"):
        load_dem(path, center=(46.5, 7.5), size_m=SIZE)
    with pytest.raises(TerrainError, match="Leave out"):
        load_dem(path, center=(lat, lon), size_m=SIZE, declared=DeclaredHeights("ft"))


def test_files_of_neighbouring_degrees_are_one_ground(tmp_path):
    """Over the border of two degrees, as the autopilot flies."""

    def plane(lat, lon):
        return 500 + 2000 * (lat - 46) + 3000 * (lon - 7)

    write_degree(tmp_path, 46, 7, plane, rows=range(2), columns=range(26, 28))
    write_degree(tmp_path, 46, 8, plane, rows=range(2), columns=range(2))
    dem = load_dem(tmp_path, center=(46.02, 8.0), size_m=SIZE)
    x = np.linspace(-290, 290, 59)
    assert np.abs(np.diff(dem.height(x, 0 * x)) - np.diff(x) * 3000 / 77_300).max() < 0.5
    assert "2 .DAT" in dem.description


def damaged(content, at):
    return content[:at] + bytes([content[at] ^ 255]) + content[at + 1 :]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: damaged(c, 300), "block 0 is damaged, its checksum is wrong.*fetch it anew"),
        (lambda c: damaged(c, 2048 + 16), "block 1 is damaged"),
        (lambda c: c[:-100], "cut short"),
        (lambda c: bytes(len(c)), "holds no heights yet"),
        (lambda c: b"", "is empty"),
    ],
)
def test_damaged_files_are_refused(tmp_path, change, words):
    """A bit of a height, of the checksum itself, half a block, no block."""
    path, _ = write_degree(tmp_path, 46, 7, slope, rows=range(1), columns=range(2))
    path.write_bytes(change(path.read_bytes()))
    with pytest.raises(TerrainError, match=words) as caught:
        load_dem(path, center=(46.01, 7.01), size_m=SIZE)
    assert str(path) in str(caught.value)


def test_squares_that_were_never_filled_in_are_gaps(tmp_path):
    """The block's bits say which of its heights came from the ground station."""
    path, _ = write_degree(
        tmp_path, 46, 7, slope, rows=range(1), columns=range(1), filled=((1 << 56) - 1) ^ (1 << 27)
    )
    with pytest.raises(TerrainError, match="without a height"):
        load_dem(path, center=(46.0125, 7.0185), size_m=SIZE)
