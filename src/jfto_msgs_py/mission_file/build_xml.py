"""XML and KMZ as bytes that are the same for the same content."""

from __future__ import annotations

import io
import re
import zipfile
from xml.etree import ElementTree as ET

KML_SPACE = "http://www.opengis.net/kml/2.2"
# What no XML may hold, however it is written.
_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_EPOCH = (1980, 1, 1, 0, 0, 0)


def add(parent: ET.Element, tag: str, text: object = None, /, **attributes: str) -> ET.Element:
    """A new last child, with text where some is given."""
    child = ET.SubElement(parent, tag, attributes)
    if text is not None:
        child.text = _FORBIDDEN.sub("\ufffd", str(text))
    return child


def as_bytes(root: ET.Element) -> bytes:
    """The document of a root, indented."""
    ET.indent(root, " ")
    text: str = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()


def archive(members: dict[str, bytes]) -> bytes:
    """A KMZ of members by name."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in members.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            file.writestr(entry, content)
    return data.getvalue()


def lon_lat(lat_deg: float, lon_deg: float) -> str:
    """Longitude and latitude to a tenth of a millimetre."""
    return f"{lon_deg:.9f},{lat_deg:.9f}"
