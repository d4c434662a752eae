"""What a GDAL mosaic (.vrt) names, looked at before GDAL follows it."""

from __future__ import annotations

import html
import re
from pathlib import Path

from jfto_msgs_py.errors import TerrainError

_SOURCE = re.compile(r"<SourceFilename([^>]*)>([^<]*)</SourceFilename>|<SourceDataset>([^<]*)<")
_RELATIVE = re.compile(r'relativeToVRT\s*=\s*"1"')
_LARGEST_BYTES = 2**26


def mosaic_files(path: Path) -> list[Path]:
    """Files of a mosaic. Raises TerrainError where one is not there or lies on a network.

    GDAL opens a mosaic's files only when their cells are read, and would fetch or wait then.
    """
    return _files(path, {path.resolve()})


def _files(path: Path, above: set[Path]) -> list[Path]:
    if path.suffix.lower() != ".vrt":
        raise TerrainError(f"{path} is a packed mosaic. Unpack it beside the tiles that it names.")
    if path.stat().st_size > _LARGEST_BYTES:
        raise TerrainError(f"{path} is larger than any mosaic. Name one made by gdalbuildvrt.")
    text = path.read_text(encoding="utf-8", errors="replace")
    found = []
    for attributes, named, dataset in _SOURCE.findall(text):
        name = html.unescape(named or dataset).strip()
        if name.startswith("/vsi") and not name.startswith(("/vsizip/", "/vsigzip/")):
            raise TerrainError(
                f"{path} names {name[:80]!r}, which is no file of this computer. Download what it "
                "names and make the mosaic of that (gdalbuildvrt)."
            )
        if "://" in name:
            raise TerrainError(
                f"{path} names {name[:80]!r} on a network. Download it and make the mosaic of that "
                "(gdalbuildvrt)."
            )
        if name.startswith("/vsi") or not name:
            continue
        file = path.parent / name if _RELATIVE.search(attributes) else Path(name)
        if file.resolve() in above:
            raise TerrainError(f"{path} names itself. Make it anew with gdalbuildvrt.")
        if not file.exists():
            raise TerrainError(
                f"{path} names {name[:200]!r}, which does not exist. Copy the tiles with the "
                "mosaic, or make it anew where they lie (gdalbuildvrt)."
            )
        found.append(file)
        if file.suffix.lower() == ".vrt":
            found.extend(_files(file, above | {file.resolve()}))
    return found
