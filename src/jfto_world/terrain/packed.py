"""Elevation models packed in a .zip or .gz, read where they lie."""

from __future__ import annotations

import gzip
import zipfile
from functools import lru_cache
from pathlib import Path

from jfto_msgs_py.errors import TerrainError

PACKINGS = {".zip": "zip", ".gz": "gzip"}
# A tile of 1 m of Germany has 4 MB, a mosaic of a county some 2 GB.
_LARGEST_BYTES = 4 * 2**30
_PIECE_BYTES = 2**22


def kind_of(path: Path, suffixes: frozenset[str]) -> str:
    """Suffix of a file in small letters, of a packed one that of what is packed.

    `suffixes` are those of elevation models. Raises TerrainError for a .zip that cannot be read or
    holds none or several.
    """
    suffix = path.suffix.lower()
    if suffix == ".gz":
        return Path(path.stem).suffix.lower()
    return Path(member(path, suffixes)).suffix.lower() if suffix == ".zip" else suffix


def inner_name(path: Path, suffixes: frozenset[str]) -> str:
    """File name of what is packed, of a file that is not its own. Raises as `kind_of` does."""
    suffix = path.suffix.lower()
    if suffix == ".zip":
        return Path(member(path, suffixes)).name
    return path.stem if suffix == ".gz" else path.name


def member(path: Path, suffixes: frozenset[str]) -> str:
    """Name of the one elevation model in a .zip. Raises TerrainError."""
    try:
        with zipfile.ZipFile(path) as archive:
            models = [
                info
                for info in archive.infolist()
                if Path(info.filename).suffix.lower() in suffixes
                # What the Finder of macOS adds.
                and not info.filename.startswith("__MACOSX/")
            ]
    except (OSError, zipfile.BadZipFile) as error:
        raise TerrainError(
            f"{path} cannot be unpacked ({error}). Copy or download it again."
        ) from error
    if len(models) != 1:
        raise TerrainError(
            f"{path} holds {len(models)} elevation models, must hold one. Unpack it and name the "
            "one, or the folder of neighbouring tiles."
        )
    (model,) = models
    if model.flag_bits & 1:
        raise TerrainError(f"{path} is locked with a password. Unpack it and name what it holds.")
    if ".." in Path(model.filename).parts or Path(model.filename).is_absolute():
        raise TerrainError(
            f"{path} holds {model.filename[:80]!r}, a path that leads out of it. Pack it anew "
            "without folders."
        )
    _check_size(path, model.file_size)
    return model.filename


def vsi_path(path: Path, suffixes: frozenset[str]) -> str:
    """What GDAL takes for a file, packed or not. Raises TerrainError."""
    packing = PACKINGS.get(path.suffix.lower())
    if packing is None:
        return str(path)
    if packing == "gzip":
        _check_gzip(path.absolute(), path.stat().st_mtime_ns)
        return f"/vsigzip/{path.absolute()}"
    # In braces a path may hold ".zip" anywhere, and a name in it any character.
    return f"/vsizip/{{{path.absolute()}}}/{member(path, suffixes)}"


def unpacked_size(path: Path, suffixes: frozenset[str]) -> int:
    """Bytes of what a .zip or .gz holds. Raises TerrainError where it cannot be unpacked."""
    if path.suffix.lower() == ".gz":
        return _check_gzip(path.absolute(), path.stat().st_mtime_ns)
    name = member(path, suffixes)
    with zipfile.ZipFile(path) as archive:
        return archive.getinfo(name).file_size


def unpacked_bytes(path: Path, suffixes: frozenset[str]) -> bytes:
    """Content of a file, packed or not. Raises TerrainError where it cannot be unpacked."""
    try:
        if path.suffix.lower() == ".zip":
            with zipfile.ZipFile(path) as archive:
                return archive.read(member(path, suffixes))
        if path.suffix.lower() == ".gz":
            _check_gzip(path.absolute(), path.stat().st_mtime_ns)
            return gzip.decompress(path.read_bytes())
        return path.read_bytes()
    except (OSError, EOFError, zipfile.BadZipFile) as error:
        raise TerrainError(f"{path} cannot be read ({error}). Copy it again.") from error


@lru_cache(maxsize=64)
def _check_gzip(path: Path, changed_ns: int) -> int:  # noqa: ARG001
    """A .gz says nothing of its size that can be relied on: it is unpacked once, and forgotten.

    What is told is how many bytes that were.
    """
    size = 0
    try:
        with gzip.open(path) as stream:
            while piece := stream.read(_PIECE_BYTES):
                size += len(piece)
                _check_size(path, size)
        return size
    except (OSError, EOFError) as error:
        raise TerrainError(
            f"{path} cannot be unpacked ({error}). Copy or download it again."
        ) from error


def _check_size(path: Path, size: int) -> None:
    if size > _LARGEST_BYTES:
        raise TerrainError(
            f"{path} holds more than {_LARGEST_BYTES // 2**30} GiB unpacked. Unpack it where there "
            "is room and name what it holds, or cut the area out of it (gdalwarp -te)."
        )
