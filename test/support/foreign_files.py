"""Files of other programs: tables of Litchi, KML and DJI's waylines, written piece by piece."""

from __future__ import annotations

import math
import zipfile
from pathlib import Path

CASES = Path(__file__).parents[1] / "data/cases"
LAT, LON, GROUND = 46.2, 7.6, 1500.0
NORTH = 1 / 111_150.0
EAST = NORTH / math.cos(math.radians(LAT))
XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
KML_SPACE = 'xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2"'
DJI_SPACE = 'xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/1.0.6"'


def tag(name, *content):
    return f"<{name}>{''.join(map(str, content))}</{name.split()[0]}>"


def dji(name, *content):
    return tag(f"wpml:{name}", *content)


KML = XML + tag(f"kml {KML_SPACE}", tag("Document", "{}"))
WPML = XML + tag(f"kml {DJI_SPACE}", tag("Document", "<wpml:missionConfig/>{}"))
LITCHI = (
    "latitude,longitude,altitude(m),heading(deg),curvesize(m),rotationdir,gimbalmode,"
    "gimbalpitchangle,actiontype1,actionparam1,actiontype2,actionparam2,altitudemode,speed(m/s),"
    "poi_latitude,poi_longitude,poi_altitude(m),poi_altitudemode,photo_timeinterval,"
    "photo_distinterval\n"
)


def write(tmp_path, name, text):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def kmz(tmp_path, **members):
    path = tmp_path / "w.KMZ"
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in members.items():
            archive.writestr(name.replace("__", "/").replace("_dot_", "."), text)
    return path


def mark(north_m, height, mode="absolute", extra="", name="w", east_m=0.0):
    return (
        f"<Placemark><name>{name}</name>{extra}<Point>"
        + (f"<altitudeMode>{mode}</altitudeMode>" if mode else "")
        + f"<coordinates> {LON + east_m * EAST},{LAT + north_m * NORTH},{height} </coordinates>"
        "</Point></Placemark>"
    )


def action(name, **given):
    inner = [dji(key, value) for key, value in given.items()]
    return dji("action", dji("actionActuatorFunc", name), dji("actionActuatorFuncParam", *inner))


def group(*actions, trigger="reachPoint", every="", start=None, end=0):
    return dji(
        "actionGroup",
        "" if start is None else dji("actionGroupStartIndex", start),
        dji("actionGroupEndIndex", end),
        dji("actionTrigger", dji("actionTriggerType", trigger), dji("actionTriggerParam", every)),
        *actions,
    )


def stop(index, north_m, height, *groups, mode="smoothTransition", angle=0, poi="0,0,0"):
    heading = {
        "waypointHeadingMode": mode,
        "waypointHeadingAngle": angle,
        "waypointPoiPoint": poi,
    }
    return tag(
        "Placemark",
        tag("Point", tag("coordinates", f"\n{LON},{LAT + north_m * NORTH}\n")),
        dji("index", index),
        dji("executeHeight", height),
        dji("waypointHeadingParam", *(dji(key, value) for key, value in heading.items())),
        *groups,
    )


def wayline(*stops, mode="relativeToStartPoint"):
    return tag("Folder", dji("executeHeightMode", mode), dji("autoFlightSpeed", 5), *stops)


def djis(tmp_path, *waylines, config=""):
    body = WPML.format("".join(waylines))
    template = WPML.format("").replace("<wpml:missionConfig/>", dji("missionConfig", config))
    return kmz(tmp_path, wpmz__template_dot_kml=template, wpmz__waylines_dot_wpml=body)


TAKE_OFF = f"<wpml:takeOffRefPoint>{LAT},{LON},1552.3</wpml:takeOffRefPoint>"


def litchi(*rows, header=LITCHI):
    return header + "".join(f"{','.join(map(str, row))}\n" for row in rows)


def leg(
    north_m,
    height=80,
    heading=0,
    gimbal=(2, -90),
    actions=(-1, 0, -1, 0),
    mode=0,
    poi=(0, 0, 0, 0),
    often=(-1, -1),
):
    return (
        LAT + north_m * NORTH,
        LON,
        height,
        heading,
        0,
        0,
        *gimbal,
        *actions,
        mode,
        5,
        *poi,
        *often,
    )
