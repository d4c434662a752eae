"""Waypoints of tables, and of Litchi's."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage import Assumed, read_waypoint_set, read_waypoints
from jfto_world.terrain import load_dem
from jfto_world.terrain.geoid import geoid_height
from support.foreign_files import CASES, EAST, LAT, LITCHI, LON, NORTH, leg, litchi, write


@pytest.fixture(scope="module")
def dem():
    """Sloping ground, 1500 m in the middle."""
    return load_dem(CASES / "00-ground.tif", center=(LAT, LON), size_m=(400.0, 400.0))


def test_a_height_is_above_what_its_column_says(tmp_path, dem):
    """Sea level, ground, home or the terrain's datum, in metres or feet; all are one place."""
    for column, value, home in (
        ("amsl_m", 1580, None),
        ("Altitude (m)", 1580, None),
        ("agl_m", 80, None),
        ("AGL_ft", 80 / 0.3048, None),
        ("above_home_m", 80, (LAT, LON)),
        ("height-above-takeoff [ft]", 80 / 0.3048, (LAT, LON)),
    ):
        path = write(tmp_path, "w.csv", f"Latitude,Lng,{column}\n{LAT},{LON},{value}\n")
        found = read_waypoint_set(path, dem, Assumed(home))
        assert found.waypoints[0].position_m == pytest.approx((0, 0, 80), abs=0.02), column
        assert bool(found.notes) == (home is not None)


def test_a_column_tells_each_row_its_reference(tmp_path, dem):
    """`alt` is above what height_reference says, row by row; another column is unused."""
    text = (
        "lat,lon,alt,height_reference,agl_m\n"
        f"{LAT},{LON},1580,AMSL,1\n{LAT},{LON + 9 * EAST},80,Above-Ground,1\n"
        f"{LAT},{LON + 19 * EAST},80,take-off,1\n"
    )
    found = read_waypoint_set(write(tmp_path, "w.csv", text), dem, Assumed((LAT, LON)))
    heights = [w.position_m[2] for w in found.waypoints]
    ground = float(dem.height(found.waypoints[1].position_m[0], 0.0))
    assert heights == pytest.approx([80, 80 + ground, 80], abs=0.05)
    assert found.notes[-1].endswith("not used: agl_m")


def test_other_separators_decimal_commas_and_marks(tmp_path, dem):
    """Semicolons or tabs, commas in decimals, a byte order mark, any line end, upper case, ß."""
    rows = ["lat;lon;agl_m;Heading (deg);pitch;Bemerkung", f"{LAT};{LON};80,5;12,25;-45;Straße"]
    for separator in ";\t":
        for end in ("\n", "\r\n", "\r"):
            text = end.join(row.replace(";", separator) for row in ("# made by hand", *rows)) + end
            path = write(tmp_path, f"Straße {len(end)}.CSV", ("\ufeff" + text).encode())
            found = read_waypoint_set(path, dem)
            (one,) = found.waypoints
            assert one.position_m[2] == pytest.approx(80.5, abs=0.02)
            assert (one.yaw_deg, one.pitch_deg) == (12.25, -45)
            assert found.notes == (f"{path}: not used: bemerkung",)


DIALECTS = st.fixed_dictionaries(
    {
        "separator": st.sampled_from(",;\t"),
        "comma": st.booleans(),
        "mark": st.booleans(),
        "end": st.sampled_from(["\n", "\r\n", "\r"]),
        "suffix": st.sampled_from([".csv", ".CSV", ".Csv"]),
        "unit": st.sampled_from(["m", "ft"]),
        "above": st.sampled_from(["amsl", "agl", "home", "ellipsoid", "column"]),
        "place": st.tuples(st.floats(-190, 190), st.floats(-190, 190), st.floats(60, 900)),
        "view": st.tuples(st.floats(0, 359), st.floats(-90, 45)),
    }
)


@settings(deadline=None, derandomize=True, max_examples=60)
@given(DIALECTS)
def test_a_table_of_any_dialect_is_one_place(tmp_path_factory, dem, dialect):
    """Separator, decimal sign, mark, line end, suffix, unit and height reference: to 1 cm."""
    east, north, up = dialect["place"]
    lat, lon, alt = (float(value) for value in dem.to_geodetic((east, north, up)))
    ground = float(dem.to_geodetic((east, north, float(dem.height(east, north))))[2])
    home = float(dem.to_geodetic((0.0, 0.0, float(dem.height(0.0, 0.0))))[2])
    above = dialect["above"]
    geoid = float(geoid_height(lat, lon))
    base = {"agl": ground, "home": home, "ellipsoid": -geoid}.get(above, 0.0)
    height = (alt - base) / (0.3048 if dialect["unit"] == "ft" else 1.0)
    names = [f"alt ({dialect['unit']})", "height_reference"]
    values = [f"{height:.4f}", "amsl" if above == "column" else above]
    if above == "column":
        names, values = [f"alt_msl_{dialect['unit']}"], values[:1]
    yaw, pitch = dialect["view"]
    rows = [
        ["Latitude", "Longitude", *names, "Gimbal Pitch", "bearing"],
        [f"{lat:.9f}", f"{lon:.9f}", *values, f"{pitch:.3f}", f"{yaw:.3f}"],
    ]
    if dialect["comma"] and dialect["separator"] != ",":
        rows[1] = [value.replace(".", ",") for value in rows[1]]
    text = "".join(dialect["separator"].join(row) + dialect["end"] for row in rows)
    path = tmp_path_factory.mktemp("dialect") / f"Tabelle{dialect['suffix']}"
    path.write_bytes(text.encode("utf-8-sig" if dialect["mark"] else "utf-8"))
    (one,) = read_waypoints(path, dem, Assumed((LAT, LON)))
    assert one.position_m == pytest.approx((east, north, up), abs=0.01)
    assert (one.yaw_deg, one.pitch_deg) == pytest.approx((yaw, pitch), abs=1e-3)


def test_litchis_table(tmp_path, dem):
    """Photos, tilt and turn as actions, a point of interest, heights above ground or take-off."""
    text = litchi(
        leg(0, heading=45, gimbal=(2, -60), actions=(0, 2000, 1, 0)),
        leg(20, actions=(4, -90, 1, 0), gimbal=(0, 0)),
        leg(40, gimbal=(1, 0), actions=(1, 0, -1, 0), poi=(LAT + 80 * NORTH, LON, 40, 0)),
        leg(60),
        leg(80, 70, actions=(1, 0, -1, 0), mode=1),
    )
    path = write(tmp_path, "litchi.csv", text)
    found = read_waypoint_set(path, dem, Assumed((LAT, LON)))
    views = [(round(w.yaw_deg, 1), round(w.pitch_deg, 1)) for w in found.waypoints]
    assert views == [(45, -60), (270, -60), (0, -45), (0, -90)]
    x, y, z = found.waypoints[3].position_m
    assert z - float(dem.height(x, y)) == pytest.approx(70, abs=0.01)
    told = " ".join(found.notes)
    assert "curvesize_m, waiting × 1" in told
    assert "1 waypoints leave the gimbal as it is" in told
    with pytest.raises(WaypointError, match=r"line 2: .*set waypoints\.home_deg"):
        read_waypoints(path, dem)


def test_litchi_in_feet_and_by_distance(tmp_path, dem):
    """altitude(ft) and mph; a photo every 10 m from the first waypoint on."""
    header = LITCHI.replace("altitude(m)", "altitude(ft)").replace("speed(m/s)", "speed(mph)")
    rows = [leg(40 * k, 80 / 0.3048, often=(-1, 10 / 0.3048)) for k in range(2)]
    found = read_waypoints(
        write(tmp_path, "l.csv", litchi(*rows, header=header)), dem, Assumed((LAT, LON))
    )
    assert [w.position_m[1] for w in found] == pytest.approx(range(0, 41, 10), abs=0.1)
    assert found[0].position_m[2] == pytest.approx(80, abs=0.02)
