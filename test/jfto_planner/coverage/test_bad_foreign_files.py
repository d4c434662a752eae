"""What is wrong in tables, KML, waylines and archives is named with its cure."""

from __future__ import annotations

import zipfile

import pytest

from jfto_msgs_py.errors import WaypointError
from jfto_planner.coverage import read_waypoints
from jfto_world.terrain import load_dem
from support.foreign_files import (
    CASES,
    KML,
    LAT,
    LITCHI,
    LON,
    WPML,
    action,
    group,
    leg,
    litchi,
    mark,
    stop,
    wayline,
    write,
)


@pytest.fixture(scope="module")
def dem():
    """Sloping ground, 1500 m in the middle."""
    return load_dem(CASES / "00-ground.tif", center=(LAT, LON), size_m=(400.0, 400.0))


BOMB = '<?xml version="1.0"?><!DOCTYPE kml [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]><kml>&b;</kml>'
OUTSIDE = '<?xml version="1.0"?><!DOCTYPE kml SYSTEM "file:///etc/passwd"><kml/>'
GOOD = wayline(stop(0, 0, 80))
BAD = {
    "entities": ("w.kml", BOMB, "DOCTYPE"),
    "outside entity": ("w.kml", OUTSIDE, "DOCTYPE"),
    "no xml": ("w.kml", "<kml><Document>", "line 1, column"),
    "deep": ("w.kml", "<kml>" * 5000, "nested more than"),
    "other xml": ("w.kml", "<gpx/>", "begins with <gpx>"),
    "no kmz": ("w.kmz", KML.format(mark(0, 1580)), "is not a KMZ"),
    "cut kmz": ("w.kmz", b"PK\x03\x04 and no more", "cannot be unpacked"),
    "template": ("template.kml", WPML.format(""), "template of a DJI wayline"),
    "area": ("w.kml", KML.format("<Placemark><Polygon/></Placemark>"), "area.file"),
    "sea floor": ("w.kml", KML.format(mark(0, 5, "relativeToSeaFloor")), "(w): altitudeMode is"),
    "coordinates": ("w.kml", KML.format(mark(0, "1580,7")), "must be longitude,latitude,altitude"),
    "word": ("w.kml", KML.format(mark(0, "high")), "altitude is 'high'"),
    "empty line": ("w.kml", KML.format("<Placemark><LineString/></Placemark>"), "no coordinates"),
    "height mode": (
        "w.wpml",
        WPML.format(wayline(stop(0, 0, 80), mode="moon")),
        "wayline 1: exec",
    ),
    "no take-off": ("w.wpml", WPML.format(GOOD), "waypoint 0: its altitude is relative to home"),
    "heading mode": ("w.wpml", WPML.format(wayline(stop(0, 0, 80, mode="spin"))), "'spin'"),
    "trigger": (
        "w.wpml",
        WPML.format(wayline(stop(0, 0, 80, group(action("takePhoto"), trigger="moon")))),
        "actionTriggerType is 'moon'",
    ),
    "no end": (
        "w.wpml",
        WPML.format(
            wayline(stop(0, 0, 80, group(action("takePhoto"), trigger="multipleDistance", every=0)))
        ),
        "has no end",
    ),
    "no wayline": ("w.wpml", WPML.format(""), "has no wayline"),
    "unit": ("w.csv", f"lat,lon,alt(yd)\n{LAT},{LON},1700\n", "line 1: alt_yd is in 'yd'"),
    "radians": ("w.csv", f"lat,lon,alt,heading_rad\n{LAT},{LON},1580,1\n", "in radians"),
    "heading": (
        "w.csv",
        f"lat,lon,alt,heading\n{LAT},{LON},1580,1000\n",
        "line 2: heading is 1000, outside -360…360 deg",
    ),
    "pitch": (
        "w.csv",
        f"lat,lon,alt,gimbal_pitch\n{LAT},{LON},1580,-90.5\n",
        "line 2: gimbal_pitch is -90.5, outside -90…90 deg",
    ),
    "pitch of a feature": (
        "w.geojson",
        (
            '{"type": "Feature", "properties": {"pitch": 100}, "geometry": '
            f'{{"type": "Point", "coordinates": [{LON}, {LAT}, 1580]}}}}'
        ),
        "w.geojson: pitch is 100, outside",
    ),
    "heading of a placemark": (
        "w.kml",
        (
            '<kml xmlns="http://www.opengis.net/kml/2.2"><Placemark><ExtendedData><Data name="yaw">'
            "<value>-361</value></Data></ExtendedData><Point><altitudeMode>absolute</altitudeMode>"
            f"<coordinates>{LON},{LAT},1580</coordinates></Point></Placemark></kml>"
        ),
        "yaw is -361, outside",
    ),
    "reference": (
        "w.csv",
        f"lat,lon,alt,height_reference\n{LAT},{LON},1580,moon\n",
        "line 2: height_reference is 'moon'",
    ),
    "local home": ("w.csv", "x_m,y_m,above_home_m\n0,0,80\n", "needs latitude and longitude"),
    "no home": ("w.csv", f"lat,lon,above_home_m\n{LAT},{LON},80\n", "waypoints.home_deg"),
    "litchi mode": ("w.csv", litchi(leg(0, mode=7)), "line 2: altitudemode is 7"),
    "litchi action": ("w.csv", litchi(leg(0, actions=(9, 0, -1, 0))), "actiontype1 is 9"),
    "litchi unit": (
        "w.csv",
        litchi(leg(0), header=LITCHI.replace("altitude(m)", "altitude(fathoms)")),
        "altitude is in 'fathoms'",
    ),
    "litchi poi": ("w.csv", litchi(leg(0, gimbal=(1, 0))), "name no place"),
}


@pytest.mark.parametrize("case", BAD, ids=str)
def test_bad_files_are_refused_with_item_and_cure(tmp_path, dem, case):
    """Each names the file, what is wrong where, and ends with what to do."""
    name, content, reason = BAD[case]
    path = write(tmp_path, name, content)
    with pytest.raises(WaypointError) as caught:
        read_waypoints(path, dem)
    told = str(caught.value)
    assert str(path) in told
    assert reason in told
    assert ". " in told or "must be" in told
    assert told.endswith((".", ")."))


def test_an_archive_that_grows_is_stopped(tmp_path, dem):
    """A member of more than 64 MiB once unpacked is not unpacked further."""
    path = tmp_path / "w.kmz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("doc.kml", b" " * (65 * 2**20))
    with pytest.raises(WaypointError, match=r"doc\.kml is larger than 64 MiB"):
        read_waypoints(path, dem)
