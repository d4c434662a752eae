"""Files: text in and out, and JSON that is one record of a declared type, strictly.

A record is a dataclass; its annotations say what a file may hold, those of `records.fields` more
narrowly. Whatever does not fit is an error that names the file, the place, what stands there, what
may stand there, and the cure.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
import math
import os
import types
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin, get_type_hints

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.fields import FILLED, NULL_IS_NAN, OneOf, Range
from jfto_msgs_py.scenario.value import nearest

Record = TypeVar("Record")

_NAMES = {dict: "an object", list: "a list", str: "text", bool: "true or false", type(None): "null"}
_FARTHEST = 1e300


@dataclass(frozen=True)
class FileKind:
    """A kind of file: what it is called, what to do about a broken one, and how it begins.

    `denial` says that a file is none. A file's first keys are `format` and `version` where they are
    given; where older ones are read too, `versions_read` lists all. A `sparse` file
    may leave out whatever has a default. All errors are `error`.
    """

    what: str
    cure: str
    denial: str = ""
    format: str = ""
    version: int = 1
    versions_read: tuple[int, ...] = ()
    size_limit: int = 1_000_000
    error: type[InputError] = InputError
    sparse: bool = False

    def fault(self, text: str, cure: str | None = None) -> InputError:
        """The error with a text and a cure, this kind's where None."""
        return self.error(f"{text} {self.cure if cure is None else cure}".rstrip())


@dataclass(frozen=True)
class Place:
    """A value inside a file and the dotted name of where it stands."""

    value: Any
    file: str
    kind: FileKind
    where: str = ""

    def fault(self, reason: str, cure: str | None = None) -> InputError:
        """Error that names the file and this place."""
        return self.kind.fault(f"{self.file}: {self.where or 'the file'} {reason}", cure)

    def member(self, name: str) -> Place:
        """A member of an object."""
        where = f"{self.where}.{name}" if self.where else name
        return Place(self.value[name], self.file, self.kind, where)

    def entries(self) -> list[Place]:
        """Entries of a list."""
        self.need(list)
        return [
            Place(value, self.file, self.kind, f"{self.where}[{index}]")
            for index, value in enumerate(self.value)
        ]

    def need(self, kind: type) -> None:
        """Raise the error that this is of another kind."""
        if not isinstance(self.value, kind):
            raise self.fault(f"is {self.shown}, must be {_NAMES[kind]}.")

    @property
    def shown(self) -> str:
        """The value as errors show it."""
        return _NAMES.get(type(self.value), f"{self.value!r:.40}")


def read_text(path: Path, error: type[InputError], what: str, size_limit: int) -> str:
    """Text of a UTF-8 file of at most `size_limit` bytes; raises `error` if that fails.

    `what` names the kind of file that is asked for, such as "scenario".
    """
    try:
        return read_data(path, error, what, size_limit).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise error(f"{path}: is not a text file. Name a {what} file in UTF-8.") from None


def read_data(path: Path, error: type[InputError], what: str, size_limit: int) -> bytes:
    """Bytes of a file, as `read_text` reads it."""
    try:
        if path.is_dir():
            raise error(f"{path}: is a directory. Name a {what} file.")
        if path.stat().st_size > size_limit:
            raise error(
                f"{path}: has {path.stat().st_size / 1e6:.1f} MB, more than any {what} file "
                f"({size_limit / 1e6:g} MB). Is it the right file?"
            )
        return path.read_bytes()
    except FileNotFoundError:
        raise error(f"{path}: no such file.{_alternatives(path)}") from None
    except PermissionError:
        raise error(f"{path}: may not be read. Check its permissions.") from None
    except (OSError, ValueError) as cause:
        # Not every name can be one of a file.
        reason = getattr(cause, "strerror", None) or cause
        raise error(f"{path}: cannot be read: {reason}. Check the path.") from None


def _alternatives(path: Path) -> str:
    """Names of files of the same kind beside the missing one."""
    folder = path.parent
    if not folder.is_dir():
        return f" There is no directory {folder} either; check the path."
    names = sorted(entry.name for entry in folder.glob(f"*{path.suffix}") if entry.is_file())[:6]
    if not names or not path.suffix:
        return " Check the path."
    return f" {folder}/ has {', '.join(names)}."


def write_file(path: Path, content: str | bytes) -> None:
    """Write one file as `write_files` does."""
    write_files({path: content})


def write_files(contents: Mapping[Path, str | bytes]) -> None:
    """Write files, all or none: under temporary names, renamed once all are there, so that nobody
    ever sees half of it. Text goes out as UTF-8. Raises InputError for what cannot be written.
    """
    ready, path = dict[Path, Path](), Path()
    try:
        for path, content in contents.items():
            ready[path] = path.with_name(f".{path.name}.{os.getpid()}.tmp")
            path.parent.mkdir(parents=True, exist_ok=True)
            ready[path].write_bytes(content.encode() if isinstance(content, str) else content)
            if path.is_dir():
                raise IsADirectoryError(0, "Is a directory")
        for path, temporary in ready.items():
            temporary.replace(path)
    except OSError as cause:
        # Where even the half-written file cannot be removed, the first error is the one to tell.
        with contextlib.suppress(OSError):
            for temporary in ready.values():
                temporary.unlink(missing_ok=True)
        cure = "Name another place with --out."
        raise InputError(f"{path}: cannot be written: {cause.strerror}. {cure}") from None


def write_json(path: Path, facts: Any) -> Path:
    """Write values as `plain` has them as JSON; returns the path. Raises InputError."""
    write_file(path, json.dumps(plain(facts), indent=1) + "\n")
    return path


def plain(value: object, decimals: int | None = None) -> Any:
    """Records, arrays and containers as values that JSON has: what is not finite becomes null.

    With `decimals` numbers are rounded to so many, and minus zero is zero.
    """
    if dataclasses.is_dataclass(value):
        fields = dataclasses.fields(value)
        return {field.name: plain(getattr(value, field.name), decimals) for field in fields}
    if isinstance(value, Mapping):
        return {name: plain(entry, decimals) for name, entry in value.items()}
    # An array, by what it can do: who reads files need not load numpy.
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(entry, decimals) for entry in value]
    if isinstance(value, float):
        if not math.isfinite(value):
            return None
        return value if decimals is None else round(value, decimals) + 0.0
    return value


def read_record(path: Path, record: type[Record], kind: FileKind) -> Record:
    """The record in a JSON file; raises the kind's error."""
    text = read_text(path, kind.error, kind.what, kind.size_limit)
    return record_of_text(text, str(path), record, kind)


def write_record(record: Any, path: Path, kind: FileKind) -> None:
    """Write a dataclass of finite numbers as JSON; raises InputError."""
    head = {"format": kind.format, "version": kind.version} if kind.format else {}
    write_json(path, head | dataclasses.asdict(record))


def record_of_text(text: str, name: str, record: type[Record], kind: FileKind) -> Record:
    """The record in a JSON text; `name` names the file in errors. Raises the kind's error."""
    place = Place(_parse(text, name, kind), name, kind)
    head: tuple[str, ...] = ()
    if kind.format:
        head = ("format", "version")
        document = place.value if isinstance(place.value, dict) else {}
        if document.get("format") != kind.format:
            denial = kind.denial or f"is no {kind.what}"
            raise kind.fault(f'{name}: {denial}: its key format is not "{kind.format}".')
        version = document.get("version")
        readable = kind.versions_read or (kind.version,)
        if version not in readable or isinstance(version, bool):
            known = " and ".join(map(str, readable))
            raise kind.fault(f"{name}: version is {version!r}, this program reads {known}.")
    found: Record = _record(place, record, head)
    return found


def record_of_values(values: Any, name: str, record: type[Record], kind: FileKind) -> Record:
    """The record in plain values, as YAML has them, of the file `name`; raises the kind's error."""
    found: Record = _record(Place(values, name, kind), record)
    return found


def _parse(text: str, name: str, kind: FileKind) -> Any:
    """JSON without NaN, infinities or doubled keys."""

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        seen = dict(pairs)
        if len(seen) != len(pairs):
            names = [key for key, _ in pairs]
            twice = next(key for key in names if names.count(key) > 1)
            raise kind.fault(f"{name}: {twice} is given twice in one object.", "Remove one.")
        return seen

    def no_constant(constant: str) -> None:
        raise kind.fault(f"{name}: holds {constant}, which JSON does not know.")

    try:
        return json.loads(text, object_pairs_hook=unique, parse_constant=no_constant)
    except json.JSONDecodeError as error:
        raise kind.fault(
            f"{name}:{error.lineno}: is not valid JSON: {error.msg} at column {error.colno}. "
            "Is the file complete?"
        ) from None
    except RecursionError:
        raise kind.fault(f"{name}: is nested too deep.", f"Is it a {kind.what} file?") from None
    except ValueError as error:
        raise kind.fault(f"{name}: is not valid JSON: {error}.") from None


@lru_cache(maxsize=64)
def _fields(record: type, sparse: bool) -> dict[str, tuple[Any, bool]]:
    """Annotation of each field of a dataclass, and whether a file may leave it out."""
    hints = get_type_hints(record, include_extras=True)
    return {
        field.name: (
            hints[field.name],
            bool(field.metadata.get("may_lack")) or (sparse and _has_default(field)),
        )
        for field in dataclasses.fields(record)
        if field.init
    }


def _has_default(field: dataclasses.Field[Any]) -> bool:
    missing = dataclasses.MISSING
    return field.default is not missing or field.default_factory is not missing


def _record(place: Place, record: Any, head: tuple[str, ...] = ()) -> Any:
    place.need(dict)
    fields = _fields(record, place.kind.sparse)
    known = [*head, *fields]
    for name in place.value:
        if name not in known:
            guess = nearest(name, known)
            cure = f"Did you mean {guess}?" if guess else f"Known are {', '.join(known)}."
            raise place.fault(f"has an unknown key {name}.", cure)
    for name, (_, may_lack) in fields.items():
        if name not in place.value and not may_lack:
            raise place.fault(f"lacks {name}.")
    values = {
        name: _value(place.member(name), hint)
        for name, (hint, _) in fields.items()
        if name in place.value
    }
    try:
        return record(**values)
    except InputError as error:
        raise place.kind.fault(f"{place.file}: {error}") from None


def _value(place: Place, hint: Any, *notes: Any) -> Any:
    """The value at a place as an annotation wants it."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _value(place, arguments[0], *arguments[1:])
    if origin in {Union, types.UnionType}:
        (some,) = (each for each in arguments if each is not type(None))
        return None if place.value is None else _value(place, some, *notes)
    if origin is tuple:
        return _entries(place, arguments)
    if origin in {dict, Mapping}:
        place.need(dict)
        return {name: _value(place.member(name), arguments[1]) for name in place.value}
    return _record(place, hint) if dataclasses.is_dataclass(hint) else _scalar(place, hint, notes)


def _entries(place: Place, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    entries = place.entries()
    if arguments[-1] is Ellipsis:
        return tuple(_value(entry, arguments[0]) for entry in entries)
    if len(entries) != len(arguments):
        raise place.fault(f"has {len(entries)} entries, needs {len(arguments)}.")
    return tuple(map(_value, entries, arguments))


def _scalar(place: Place, kind: Any, notes: tuple[Any, ...]) -> Any:
    value = place.value
    if kind is float:
        if value is None and NULL_IS_NAN in notes:
            return math.nan
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise place.fault(f"is {place.shown}, must be a number.")
        _need_finite(place)
        value = float(value)
    elif kind is int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise place.fault(f"is {place.shown}, must be a whole number.")
        _need_finite(place)
    elif kind is not Any:
        place.need(kind)
    for note in notes:
        if isinstance(note, Range) and (problem := note.problem(value)):
            raise place.fault(f"is {value:g}, {problem}.")
        if isinstance(note, OneOf) and value not in note.words:
            raise place.fault(f"is {value!r}, must be one of {', '.join(note.words)}.", "")
        if note is FILLED and not value:
            raise place.fault("is empty.", "Give it a value.")
    return value


def _need_finite(place: Place) -> None:
    if abs(place.value) > _FARTHEST:
        raise place.fault(f"is {place.shown}, must be finite.")
