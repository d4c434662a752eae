"""Tables of text: a header, then one row a line, with whichever separator and decimal sign."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass

from jfto_msgs_py.mission_file.document import MissionTextError
from jfto_msgs_py.mission_file.points import number

_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+")
# A unit in brackets at the end of a column's name, as "altitude(m)".
_BRACKETS = re.compile(r"[\s_]*[(\[]\s*([^)\]]*)[)\]]$")


@dataclass(frozen=True)
class Row:
    """One row: `cells` by the column's name; `place` names file and line."""

    place: str
    cells: dict[str, str]

    def number(self, column: str) -> float:
        """The number in a column. Raises MissionTextError."""
        if column not in self.cells:
            raise MissionTextError(
                f"{self.place}: needs the column {column}, which the header lacks. Add it, or "
                "export the file again."
            )
        return number(self.cells[column], column, self.place)


@dataclass(frozen=True)
class Table:
    """Header (names in small letters, units behind an underscore) and rows of a file."""

    source: str
    header: tuple[str, ...]
    rows: tuple[Row, ...]
    separator: str

    def once(self, known: set[str]) -> None:
        """Raise MissionTextError where one of the known columns is there twice."""
        doubled = sorted({n for n in self.header if n in known and self.header.count(n) > 1})
        if doubled:
            raise MissionTextError(
                f"{self.source}, line 1: column {doubled[0]} appears twice. Take one out."
            )


def column_name(name: str) -> str:
    """A column's name as everything here looks it up: "Altitude (m)" is altitude_m."""
    bare = _BRACKETS.sub(r"_\1", name.strip().lower())
    return re.sub(r"[\s\-/]+", "_", bare).strip("_")


def read_table(text: str, source: str) -> Table:
    """A table separated by commas, semicolons or tabs; lines that begin with # are comments.

    Beside semicolons and tabs decimals may have a comma. Raises MissionTextError.
    """
    first = next((line for line in text.splitlines() if line.strip() and line[0] != "#"), "")
    separator = max(",;\t", key=first.count)
    reader = csv.reader(io.StringIO(text, newline=None), strict=True, delimiter=separator)
    try:
        lines = [
            (reader.line_num, row)
            for row in reader
            if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
        ]
    except csv.Error as error:
        raise MissionTextError(
            f"{source}, line {reader.line_num}: is not CSV ({error}). Check its quotes."
        ) from error
    if not lines:
        raise MissionTextError(f"{source}: has comments only. Write a header and rows into it.")
    header = tuple(column_name(cell) for cell in lines[0][1])
    rows = tuple(_rows(lines[1:], header, source, separator))
    return Table(source, header, rows, separator)


def _rows(
    lines: list[tuple[int, list[str]]], header: tuple[str, ...], source: str, separator: str
) -> Iterator[Row]:
    for line, row in lines:
        place = f"{source}, line {line}"
        # A separator at the end of each line is a spreadsheet's habit.
        if len(row) == len(header) + 1 and not row[-1].strip():
            row = row[:-1]  # noqa: PLW2901
        if len(row) != len(header):
            raise MissionTextError(
                f"{place}: has {len(row)} values, the header names {len(header)}. Separate values "
                "with commas and write decimals with a point, or separate with semicolons."
            )
        cells = [cell.strip() for cell in row]
        if separator != ",":
            cells = [c.replace(",", ".") if _DECIMAL_COMMA.fullmatch(c) else c for c in cells]
        yield Row(place, dict(zip(header, cells, strict=True)))
