"""What lies in a run directory, and whether it still is what would be made anew."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata
from pathlib import Path

import jfto
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import FileKind, read_record, write_record

MADE_NAME = "made.json"
# Other versions of these may draw or compute otherwise.
_LIBRARIES = ("numpy", "scipy", "numba", "matplotlib", "plotly")
_PIECE_BYTES = 2**22


_KIND = FileKind("record of what was made", "Delete it: everything is made anew.")


@dataclass(frozen=True)
class _Made:
    """Digest of the inputs, and of each file that they came to."""

    inputs: str
    files: dict[str, str]


@dataclass(frozen=True)
class _Memory:
    """What was made, by the name of the product."""

    products: dict[str, _Made] = field(default_factory=dict)


class Products:
    """Knows of each product of a directory from what it was made, and which files it came to.

    That is written to made.json. With `anew` nothing is kept.
    """

    def __init__(self, directory: Path, *, anew: bool = False) -> None:
        self._directory, self._anew = directory, anew
        self._path = directory / MADE_NAME
        try:
            self._made = read_record(self._path, _Memory, _KIND).products
        except InputError:
            # None yet, or damaged: then everything is made anew.
            self._made = {}

    def kept(self, product: str, inputs: str) -> tuple[Path, ...]:
        """Files of a product that was made of inputs with this digest.

        None where it has to be made: also where a file is gone, or somebody has changed it.
        """
        made = self._made.get(product)
        if self._anew or made is None or made.inputs != inputs:
            return ()
        files = {self._directory / name: had for name, had in made.files.items()}
        return tuple(files) if all(_of_file(one) == had for one, had in files.items()) else ()

    def made(self, product: str, inputs: str, files: Iterable[Path]) -> None:
        """Remember that the product was made of inputs with this digest and lies in these files."""
        names = {str(path.relative_to(self._directory)): _of_file(path) for path in files}
        self._made[product] = _Made(inputs, names)
        write_record(_Memory(self._made), self._path, _KIND)


def digest(inputs: Iterable[str | bytes | Path]) -> str:
    """SHA-256 of texts and of files' contents, and of the program that makes something of them."""
    sum_ = hashlib.sha256(_program().encode())
    for one in inputs:
        part = _of_file(one) if isinstance(one, Path) else one
        part = part.encode() if isinstance(part, str) else part
        # With their lengths, so that no two lists of inputs look alike.
        sum_.update(f"{len(part)}:".encode() + part)
    return sum_.hexdigest()


def _of_file(path: Path) -> str:
    sum_ = hashlib.sha256()
    try:
        with path.open("rb") as file:
            # In pieces: elevation models are larger than memory.
            while piece := file.read(_PIECE_BYTES):
                sum_.update(piece)
    except OSError:
        return "absent"
    return sum_.hexdigest()


@cache
def _program() -> str:
    """Digest of our code, weights and templates, and versions of libraries."""
    sum_ = hashlib.sha256(jfto.__version__.encode())
    root = Path(jfto.__file__).parents[1]
    for path in sorted(root.glob("jfto*/**/*")):
        if path.is_file() and "__pycache__" not in path.parts:
            sum_.update(f"{path.relative_to(root)}:{_of_file(path)}\n".encode())
    sum_.update(json.dumps([metadata.version(library) for library in _LIBRARIES]).encode())
    return sum_.hexdigest()
