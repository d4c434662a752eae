"""Text of files that other programs wrote: UTF-8, UTF-16 with its mark, or a Windows code page."""

from __future__ import annotations

import re
from pathlib import Path

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import read_data

_MARKS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe\x00\x00", "utf-32"),
    (b"\x00\x00\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
# Control characters but tab, line ends, form feed and the end mark of old DOS programs.
_BINARY = re.compile("[\x00-\x08\x0b\x0e-\x19\x1b-\x1f]")


def read_foreign_text(path: Path, what: str, size_limit: int) -> tuple[str, str]:
    """A file's text, and the name of its encoding where that is not UTF-8 ("" else).

    `what` names the kind of file asked for, such as "mission". Raises InputError for a file that is
    missing, larger than `size_limit` bytes, or not text.
    """
    return decode(read_data(path, InputError, what, size_limit), str(path), f"{what} file")


def decode(data: bytes, name: str, what: str) -> tuple[str, str]:
    """Text of a file's bytes and its encoding, as `read_foreign_text`. Raises InputError."""
    marked = next((codec for mark, codec in _MARKS if data.startswith(mark)), None)
    try:
        text = data.decode(marked or "utf-8")
        encoding = marked if marked and marked != "utf-8-sig" else ""
    except UnicodeDecodeError as error:
        if marked:
            raise InputError(
                f"{name}: begins as {marked.upper()} but is not ({error.reason} at byte "
                f"{error.start}). Save the {what} in UTF-8."
            ) from None
        # Every byte is a character there; what is none, the next check finds.
        text, encoding = data.decode("latin-1"), "latin-1"
    if found := _BINARY.search(text):
        raise InputError(
            f"{name}: is not a text file (character {ord(found.group()):#04x} at "
            f"{found.start()}). Save the {what} in UTF-8."
        )
    return text, encoding
