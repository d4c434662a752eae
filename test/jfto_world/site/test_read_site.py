"""Polygons of files of every kind, and what is said of bad ones."""

import json
import zipfile
from pathlib import Path

import numpy as np
import pyogrio
import pytest
import shapely
from pyproj import Transformer

from jfto_msgs_py.errors import SiteError
from jfto_world.site import SiteFile, SiteKeys, read_site

OUTER = [(104.10, 32.90), (104.12, 32.90), (104.12, 32.915), (104.11, 32.92), (104.10, 32.915)]
HOLE = [(104.105, 32.905), (104.110, 32.905), (104.110, 32.910), (104.105, 32.910)]
FIELD = shapely.Polygon(OUTER, [HOLE])
CASES = Path(__file__).parents[2] / "data" / "cases"


def write(path: Path, geometries, crs="EPSG:4326", names=None, **options) -> Path:
    pyogrio.raw.write(
        path,
        np.array([shapely.to_wkb(g) for g in geometries], dtype=object),
        [np.array(names or [f"field {k}" for k in range(len(geometries))], dtype=object)],
        ["name"],
        geometry_type=options.pop("geometry_type", geometries[0].geom_type),
        crs=crs,
        **options,
    )
    return path


def geojson(path: Path, *geometries, crs=None) -> Path:
    document = {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "properties": {"name": "n", "top_m": 120.5}, "geometry": g}
            for g in geometries
        ],
    }
    if crs:
        document["crs"] = {"type": "name", "properties": {"name": crs}}
    path.write_text(json.dumps(document))
    return path


def polygon(*rings) -> dict:
    return {"type": "Polygon", "coordinates": [[*map(list, ring), list(ring[0])] for ring in rings]}


def kml(path: Path, body: str, head: str = "") -> Path:
    path.write_text(
        f'<?xml version="1.0" encoding="UTF-8"?>{head}<kml xmlns="http://www.opengis.net/kml/2.2">'
        f"<Document>{body}</Document></kml>"
    )
    return path


def placemark(name: str, ring=OUTER, closed=True, height=0) -> str:
    corners = " ".join(f"{x},{y},{height}" for x, y in [*ring, *([ring[0]] if closed else [])])
    return (
        f"<Placemark><name>{name}</name><ExtendedData><Data name='top_m'><value>90</value></Data>"
        "</ExtendedData><Polygon><outerBoundaryIs><LinearRing><coordinates>"
        f"{corners}</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>"
    )


def plan_file(path: Path, corners) -> Path:
    survey = {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "polygon": [[lat, lon] for lon, lat in corners],
        "version": 5,
    }
    document = {"fileType": "Plan", "version": 1, "mission": {"version": 2, "items": [survey]}}
    path.write_text(json.dumps(document))
    return path


def area(found: SiteFile) -> float:
    return sum(
        shapely.Polygon(p.outer_deg, p.holes_deg).area for s in found.shapes for p in s.polygons
    )


def kinds(folder: Path):
    shp = write(folder / "field.shp", [FIELD], driver="ESRI Shapefile")
    with zipfile.ZipFile(folder / "packed.zip", "w") as archive:
        for part in folder.glob("field.*"):
            archive.write(part, part.name)
    utm = Transformer.from_crs("EPSG:4326", "EPSG:32648", always_xy=True)
    projected = shapely.transform(FIELD, lambda c: np.column_stack(utm.transform(*c.T)))
    kml_file = write(folder / "field.kml", [FIELD], driver="KML")
    with zipfile.ZipFile(folder / "field.kmz", "w") as archive:
        archive.write(kml_file, "doc.kml")
    return {
        "shp": shp,
        "zip": folder / "packed.zip",
        "utm": write(folder / "utm.gpkg", [projected], "EPSG:32648", driver="GPKG"),
        "web": write(
            folder / "web.gpkg",
            [
                shapely.transform(
                    FIELD,
                    lambda c: np.column_stack(
                        Transformer.from_crs(4326, 3857, always_xy=True).transform(*c.T)
                    ),
                )
            ],
            "EPSG:3857",
            driver="GPKG",
        ),
        "geojson": geojson(folder / "field.geojson", polygon(OUTER, HOLE)),
        "kml": kml_file,
        "kmz": folder / "field.kmz",
    }


def test_every_kind_of_file_gives_the_same_corners_and_hole(tmp_path):
    """KML, KMZ, GeoJSON, Shapefile, zipped too, and GeoPackage in any CRS: one polygon, a hole."""
    for kind, path in kinds(tmp_path).items():
        (shape,) = read_site(path).shapes
        (found,) = shape.polygons
        assert len(found.outer_deg) == len(OUTER), kind
        assert len(found.holes_deg) == 1, kind
        assert area(read_site(path)) == pytest.approx(FIELD.area, rel=1e-6), kind
        corners = {(round(lat, 6), round(lon, 6)) for lat, lon in found.outer_deg}
        assert corners == {(lat, lon) for lon, lat in OUTER}, kind


def test_a_survey_of_qgroundcontrol_gives_its_polygon(tmp_path):
    """The polygon of a survey is taken though its items are not expanded."""
    (shape,) = read_site(plan_file(tmp_path / "a.plan", OUTER)).shapes
    assert shape.polygons[0].outer_deg == tuple((lat, lon) for lon, lat in OUTER)
    (tmp_path / "b.plan").write_text('{"fileType": "Plan", "mission": {"items": []}}')
    with pytest.raises(SiteError, match="has no survey"):
        read_site(tmp_path / "b.plan")


def test_properties_are_kept_and_several_parts_too(tmp_path):
    """Numbers of GeoJSON and text of KML come as the file has them; parts stay parts."""
    (shape,) = read_site(geojson(tmp_path / "a.geojson", polygon(OUTER))).shapes
    assert shape.properties["top_m"] == 120.5
    (shape,) = read_site(kml(tmp_path / "a.kml", placemark("North"))).shapes
    assert (shape.name, shape.properties["top_m"]) == ("North", "90")
    (shape,) = read_site(CASES / "12-area.geojson").shapes
    assert len(shape.polygons[0].holes_deg) == 1


def test_heights_and_open_rings_are_said(tmp_path):
    """Heights of corners are not used and rings left open are closed, both with a word."""
    found = read_site(kml(tmp_path / "a.kml", placemark("North", closed=False, height=30)))
    assert len(found.shapes[0].polygons[0].outer_deg) == len(OUTER)
    assert "heights of its corners are not used" in " ".join(found.notes)
    assert "a ring is not closed" in " ".join(found.notes)


def test_doubled_corners_vanish(tmp_path):
    """A corner given twice in a row is one."""
    ring = [OUTER[0], OUTER[0], *OUTER[1:], OUTER[-1]]
    found = read_site(geojson(tmp_path / "a.geojson", polygon(ring)))
    assert len(found.shapes[0].polygons[0].outer_deg) == len(OUTER)


def test_points_are_kept_for_circles(tmp_path):
    """A file of points alone is read, since points may be the middles of circles."""
    found = read_site(geojson(tmp_path / "a.geojson", {"type": "Point", "coordinates": [104, 32]}))
    assert not found.shapes
    assert found.points[0].point_deg == (32.0, 104.0)
    assert found.points[0].properties["top_m"] == 120.5


def test_layers_are_named_where_several_have_areas(tmp_path):
    """One layer with polygons is taken; of several, area.layer names one; a wrong name is told."""
    path = tmp_path / "a.gpkg"
    write(path, [FIELD], driver="GPKG", layer="fields")
    write(path, [shapely.Point(104, 32)], driver="GPKG", layer="spots", append=True)
    assert read_site(path).shapes
    write(path, [FIELD], driver="GPKG", layer="woods", append=True)
    with pytest.raises(SiteError, match=r"areas in 2 layers: fields, woods\. Name one with area"):
        read_site(path)
    assert read_site(path, "woods").shapes
    with pytest.raises(SiteError, match=r"no layer 'wood' \(fence.layer\)\. It has fields"):
        read_site(path, "wood", SiteKeys("fence.file", "fence.layer"))


BOWTIE = [(104.10, 32.90), (104.12, 32.92), (104.12, 32.90), (104.10, 32.92)]
LINE = {"type": "LineString", "coordinates": [[104, 32], [104.1, 32]]}
RING = {"type": "LineString", "coordinates": [[104, 32], [104.1, 32], [104.1, 32.1], [104, 32]]}


@pytest.mark.parametrize(
    ("geometries", "words"),
    [
        ([polygon(BOWTIE)], r"crosses itself near 32.910000, 104.110000"),
        ([polygon(OUTER, [(105, 33), (105.1, 33), (105.1, 33.1)])], "a hole of it lies outside"),
        ([polygon(OUTER[:2])], "fewer than 3|cannot be read"),
        ([LINE], r"has no polygon, but 1 × line\. Draw the area as a polygon"),
        ([RING], r"1 × closed line\. Make polygons of closed lines"),
        ([], "has no feature"),
        ([{"type": "MultiPolygon", "coordinates": []}], "1 × empty MultiPolygon"),
        ([polygon([(y, x) for x, y in OUTER])], "latitude and longitude are exchanged"),
        ([polygon([(353000 + x, 3641000 + y) for x, y in OUTER])], "these look like metres"),
    ],
)
def test_bad_geometries_name_place_reason_and_cure(tmp_path, geometries, words):
    """What cannot be an area is refused by name, never mended in silence."""
    path = geojson(tmp_path / "bad.geojson", *geometries)
    with pytest.raises(SiteError, match=words) as caught:
        read_site(path)
    assert str(caught.value).startswith("area.file: ")
    assert "bad.geojson" in str(caught.value)


def test_files_that_are_none_are_refused(tmp_path):
    """Missing, empty, cut short, of another kind: file, reason and cure."""
    with pytest.raises(SiteError, match=r"area.file: .*no such file"):
        read_site(tmp_path / "none.kml")
    with pytest.raises(SiteError, match="is of no known kind"):
        read_site(tmp_path / "a.dxf")
    for name, content in {"a.kml": b"", "b.geojson": b" \n"}.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(SiteError, match="is empty"):
            read_site(tmp_path / name)
    whole = geojson(tmp_path / "whole.geojson", polygon(OUTER)).read_bytes()
    for name, content in {
        "cut.geojson": whole[: len(whole) // 2],
        "other.gpkg": whole[:100],
        "other.shp": b"text",
        "text.kml": b"no XML at all",
        "damaged.zip": b"PK\x03\x04 and no more",
        "damaged.kmz": b"PK\x03\x04 and no more",
    }.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(SiteError, match=r"area.file: .*(cannot be read|damaged)"):
            read_site(tmp_path / name)


def test_a_shapefile_without_its_crs_or_with_an_unknown_shift_is_refused(tmp_path):
    """Without a .prj nobody knows where it is; a ballpark datum shift is no shift."""
    path = write(tmp_path / "field.shp", [FIELD], driver="ESRI Shapefile")
    (tmp_path / "field.prj").unlink()
    with pytest.raises(SiteError, match=r"names no coordinate system .*\.prj"):
        read_site(path)
    xian = write(tmp_path / "xian.gpkg", [FIELD], "EPSG:4610", driver="GPKG")
    with pytest.raises(SiteError, match=r"no shift to WGS-84 .*ogr2ogr -s_srs"):
        read_site(xian)


def test_bombs_are_refused(tmp_path):
    """Entities in KML, an archive that unpacks to gigabytes, a hundred thousand corners."""
    bomb = '<!DOCTYPE k [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>'
    with pytest.raises(SiteError, match="declares XML entities"):
        read_site(kml(tmp_path / "bomb.kml", "<name>&b;</name>", bomb))
    with zipfile.ZipFile(tmp_path / "bomb.kmz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("doc.kml", b" " * (260 * 2**20))
    with pytest.raises(SiteError, match="unpacks to 273 MB"):
        read_site(tmp_path / "bomb.kmz")
    angle = np.linspace(0, 2 * np.pi, 300_001)[:-1]
    ring = np.round(np.column_stack([104 + np.cos(angle), 32 + np.sin(angle)]), 5).tolist()
    with pytest.raises(SiteError, match="more than 200000 corners"):
        read_site(geojson(tmp_path / "big.geojson", polygon(ring)))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("word", ["NaN", "Infinity"])
@pytest.mark.parametrize("crs", [None, "urn:ogc:def:crs:EPSG::32648"])
def test_corners_that_are_no_numbers_are_refused_by_the_name_of_their_feature(tmp_path, word, crs):
    """In degrees and in metres; no library warns beside."""
    path = geojson(tmp_path / "a.geojson", polygon(OUTER), crs=crs)
    path.write_text(path.read_text().replace("104.12,", f"{word},"))
    with pytest.raises(SiteError, match=r'a\.geojson, feature 1 "n": a corner is not a number'):
        read_site(path)
