"""XML of strangers, and the archives that it comes in, read with bounds."""

from __future__ import annotations

import io
import lzma
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import read_data
from jfto_msgs_py.mission_file.document import MissionTextError

LARGEST_BYTES = 64 * 2**20
_DEEPEST = 100
_ZIP = b"PK\x03\x04"
# What the unpacking of damaged archives ends in.
_BROKEN = (zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError, OSError, RuntimeError)


class _NoDoctype(ET.TreeBuilder):
    """Builds the tree, and stops at a document type: what it declares may grow without bound."""

    def __init__(self, source: str) -> None:
        super().__init__()
        self._source = source
        self._depth = 0

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:  # noqa: ARG002
        raise MissionTextError(
            f"{self._source}: declares a document type (DOCTYPE), which is not read: its entities "
            "can grow without bound. Export it again without."
        )

    def start(self, tag: str, attrs: dict[str, str]) -> ET.Element:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise MissionTextError(
                f"{self._source}: is nested more than {_DEEPEST} deep. Export it again."
            )
        return super().start(tag, attrs)

    def end(self, tag: str) -> ET.Element:
        self._depth -= 1
        return super().end(tag)


def parse_xml(data: bytes, source: str) -> ET.Element:
    """The root of a document without document type and entities. Raises MissionTextError."""
    # What entities could do is ruled out by the builder.
    parser = ET.XMLParser(target=_NoDoctype(source))  # noqa: S314
    try:
        parser.feed(data)
        root = parser.close()
    except ET.ParseError as error:
        line, column = error.position
        raise MissionTextError(
            f"{source}, line {line}, column {column + 1}: is not XML ({error.msg.split(':')[0]}). "
            "The file is damaged or cut short; export it again."
        ) from None
    except (LookupError, ValueError) as error:
        raise MissionTextError(
            f"{source}: cannot be read: {str(error)[:80]}. Save it in UTF-8."
        ) from None
    assert isinstance(root, ET.Element)
    return root


def read_bytes(path: Path, what: str) -> bytes:
    """A file's bytes; raises MissionTextError where it is missing or too large."""
    try:
        return read_data(path, InputError, what, LARGEST_BYTES)
    except InputError as error:
        raise MissionTextError(str(error)) from None


def members(data: bytes, source: str) -> dict[str, bytes]:
    """The XML members of an archive by name. Raises MissionTextError."""
    if not data.startswith(_ZIP):
        raise MissionTextError(
            f"{source}: is not a KMZ, which is a zip archive. Name a bare KML .kml, or export it "
            "again."
        )
    found: dict[str, bytes] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            for entry in archive.infolist():
                if not entry.filename.lower().endswith((".kml", ".wpml")):
                    continue
                with archive.open(entry) as file:
                    text = file.read(LARGEST_BYTES + 1)
                if len(text) > LARGEST_BYTES:
                    raise MissionTextError(
                        f"{source}: {entry.filename[:60]} is larger than {LARGEST_BYTES // 2**20} "
                        "MiB once unpacked. Split it."
                    )
                found[entry.filename] = text
    except (*_BROKEN, ValueError) as error:
        raise MissionTextError(
            f"{source}: cannot be unpacked: {str(error)[:80]}. Export it again without a password."
        ) from None
    return found


def local(tag: object) -> str:
    """An element's name without its namespace, "" for what is no element."""
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def child(element: ET.Element, name: str) -> ET.Element | None:
    """The first child of a name, in whichever namespace."""
    return next((one for one in element if local(one.tag) == name), None)


def text_of(element: ET.Element, *path: str) -> str | None:
    """Text at the end of a path of names, stripped; None where there is none."""
    here: ET.Element | None = element
    for name in path:
        here = None if here is None else child(here, name)
    return None if here is None or here.text is None else here.text.strip()


def all_of(element: ET.Element, name: str) -> Iterator[ET.Element]:
    """All elements of a name below one, in the order of the document."""
    return (one for one in element.iter() if local(one.tag) == name)
