"""One way to read all bags: mcap and sqlite3, in one file or many, whole or left by a kill."""

from __future__ import annotations

import dataclasses
import heapq
import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import yaml

from jfto.bag.contents import BagError, BagFacts, BagMessage, BagTopic
from jfto.bag.parts import IndexedPart, ScannedPart, open_part

EMPTY_START_NS = 2**63 - 1
_STORAGE = re.compile(r"\.(mcap|db3)(\.zstd)?$")


class Bag:
    """A bag that was opened; read as often as wanted."""

    def __init__(self, path: Path) -> None:
        """Open a folder, or an mcap or db3 file. Raises BagError."""
        self.path = path
        if not path.exists():
            raise BagError(f"Bag path '{path}' does not exist!")
        self._written = _metadata(path)
        self._files = [path] if path.is_file() else _files(path)
        self._parts: list[IndexedPart | ScannedPart]
        if self._written.get("compression_mode"):
            # Compressed whole or by the message, of which metadata.yaml alone tells.
            self._parts = [IndexedPart(path)]
        else:
            # A kill can leave a last file of which nothing was written yet.
            filled = [each for each in self._files if each.stat().st_size]
            self._parts = [open_part(file) for file in filled or self._files[:1]]
        self.facts = self._facts()

    def messages(self, topics: Collection[str] | None = None) -> Iterator[BagMessage]:
        """Messages of the topics named (None: all) by time; equal times in the order written.

        Raises BagError where damage is met, after what came before it.
        """
        parts = (part.messages(topics) for part in self._parts)
        return heapq.merge(*parts, key=lambda each: each.stamp_ns)

    def _facts(self) -> BagFacts:
        names = [file.name for file in self._files]
        span_ns = [moment for part in self._parts for moment in part.span_ns]
        alone = self.path.is_file()
        beside = self._files if alone else [each for each in self.path.iterdir() if each.is_file()]
        listed = [Path(each).name for each in self._written.get("relative_file_paths", ())]
        whole = all(each.complete for each in self._parts)
        return BagFacts(
            files=(str(self.path),) if alone else tuple(names),
            size_bytes=sum(each.stat().st_size for each in beside),
            storage="sqlite3" if ".db3" in names[0] else "mcap",
            distro=self._written.get("ros_distro") or "unknown",
            start_ns=min(span_ns, default=EMPTY_START_NS),
            duration_ns=max(span_ns, default=0) - min(span_ns, default=0),
            topics=_merged(self._parts),
            complete=whole and (alone or sorted(listed) == sorted(names)),
            notes=tuple(_notes(self.path, self._files, listed, whole)),
        )


def _notes(path: Path, files: list[Path], listed: list[str], whole: bool) -> Iterator[str]:
    """What of a recording is not there, or is there and not read, a line each."""
    if not whole:
        yield f"{path}: the recording was not finished; this is what was recovered."
    if path.is_file():
        beside = [each.name for each in _files(path.parent) if _series(each) == _series(path)]
        if len(beside) > 1:
            others = ", ".join(name for name in beside if name != path.name)
            yield f"{path}: is one part of a recording; {others} are not read. Name the folder."
        return
    names = [file.name for file in files]
    if not listed:
        why = "the recording was not finished, or metadata.yaml is lost"
        yield f"{path}: {why}; all {len(names)} files there are read."
        numbers = sorted(_number(file) for file in files if _series(file) == _series(files[0]))
        if numbers != list(range(numbers[0], numbers[0] + len(numbers))) or numbers[0] > 0:
            yield f"{path}: parts {', '.join(map(str, numbers))} are there, others are missing."
        return
    if missing := sorted({*listed} - {*names}):
        yield f"{path}: {', '.join(missing)} of the recording are missing."
    if more := sorted({*names} - {*listed}):
        yield f"{path}: {', '.join(more)} are read though metadata.yaml does not name them."


def _series(file: Path) -> tuple[str, str]:
    """What the parts of one recording have in common: split_3.db3 is of ("split_", ".db3")."""
    stem, _, suffix = file.name.partition(".")
    return stem.rstrip("0123456789"), f".{suffix}"


def _number(file: Path) -> int:
    return int(file.name.partition(".")[0].removeprefix(_series(file)[0]) or 0)


def _merged(parts: list[IndexedPart | ScannedPart]) -> tuple[BagTopic, ...]:
    """Topics, each once, that files or several connections in one have."""
    found: dict[str, BagTopic] = {}
    for topic in (topic for part in parts for topic in part.topics):
        known = found.get(topic.name)
        offered = dict.fromkeys((*(known.offered if known else ()), *topic.offered))
        count = topic.count + (known.count if known else 0)
        found[topic.name] = dataclasses.replace(topic, offered=tuple(offered), count=count)
    return tuple(found.values())


def _metadata(path: Path) -> dict[str, Any]:
    """What metadata.yaml says; nothing where there is none, or half of one."""
    try:
        document = yaml.safe_load((path / "metadata.yaml").read_text("utf-8"))
        found: dict[str, Any] = dict(document["rosbag2_bagfile_information"])
    except (OSError, UnicodeDecodeError, yaml.YAMLError, KeyError, TypeError, ValueError):
        return {}
    return found


def _files(path: Path) -> list[Path]:
    """The files of a bag in their order: bag_10 comes after bag_9. Raises BagError without any."""
    files = [file for file in path.iterdir() if _STORAGE.search(file.name)]
    if not files:
        raise BagError(f"{path}: cannot be read as a bag: it has no .mcap or .db3 file.")
    if len({".db3" in file.name for file in files}) > 1:
        raise BagError(
            f"{path}: holds .mcap and .db3 files, which are two recordings or one twice. Name one "
            "file, or move the others elsewhere."
        )
    return sorted(files, key=lambda file: [int(part) for part in re.findall(r"\d+", file.name)])
