"""The rows of a table of text or of a spreadsheet, as fields of text with their line.

Titles, blank lines and Excel's `sep=;` above the header are passed over. What the columns mean
is in `lists`; samples are read faster, in `samples`.
"""

import datetime as dt
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.messages import say
from herijk.warehouse.archive.text import (
    HEADER_WITHIN,
    Column,
    decode,
    find_delimiter,
    is_separator_line,
    score_of,
    split_line,
)

SPREADSHEETS: Final = (".xlsx", ".xlsm", ".xls", ".ods")
MOST_ROWS: Final = 100_000
MOST_COLUMNS: Final = 500
"""Of a list; a spreadsheet that says to have more is not one."""


@dataclass(frozen=True)
class Row:
    """One row: its line, its fields, and what is wrong with it as a whole."""

    line: int
    fields: list[str]
    problem: str | None = None


@dataclass(frozen=True)
class Sheet:
    """A table: the cells of its header, the header's line, and the rows below it."""

    header: list[str]
    line: int
    rows: list[Row]


def read_sheet(data: bytes, columns: Sequence[Column], suffix: str = ".csv") -> Sheet:
    """Return the table in a file.

    Args:
        data: content of the file.
        columns: the columns that are looked for; the header is the line that names most of them.
        suffix: kind of file, in lower case.

    Raises:
        DefectiveInputError: the file cannot be read, or a quotation mark in its header is open.
    """
    if suffix in SPREADSHEETS:
        return max(_spreadsheet(data, columns), key=lambda sheet: score_of(sheet.header, columns))
    lines = decode(data).removeprefix("\ufeff").split("\n")
    lines = [line.rstrip("\r") for line in lines]
    place = find_header(lines, columns)
    delimiter = find_delimiter(lines[place])
    header = split_line(lines[place], delimiter)
    rows = [
        _text_row(number, line, delimiter, len(header))
        for number, line in enumerate(lines[place + 1 :], start=place + 2)
    ]
    return Sheet(header, place + 1, [row for row in rows if any(map(str.strip, row.fields))])


def find_header(lines: Sequence[str], columns: Sequence[Column]) -> int:
    """Return which of the first lines is the header; the first with text where none names any."""
    first = 0
    best, most = -1, 0
    for place, line in enumerate(lines[:HEADER_WITHIN]):
        if not line.strip() or is_separator_line(line):
            first = place + 1 if first == place else first
            continue
        try:
            score = score_of(split_line(line, find_delimiter(line)), columns)
        except DefectiveInputError:
            continue
        if score > most:
            best, most = place, score
    return best if best >= 0 else min(first, len(lines) - 1)


def _text_row(number: int, line: str, delimiter: str, width: int) -> Row:
    """Read line by line: a quotation mark left open would swallow the rows below."""
    try:
        fields = split_line(line, delimiter)
    except DefectiveInputError:
        problem = say("a quotation mark is not closed, or in mid-field.")
        return Row(number, line.split(delimiter), problem)
    if len(fields) < width or any(field.strip() for field in fields[width:]):
        problem = say(
            "the row has {fields} fields where the header has {width}.",
            fields=len(fields),
            width=width,
        )
        return Row(number, fields, problem)
    return Row(number, fields)


def _spreadsheet(data: bytes, columns: Sequence[Column]) -> Iterator[Sheet]:
    """Give the sheets of a workbook, each from its header on."""
    import python_calamine  # noqa: PLC0415 - only where there is a spreadsheet

    try:
        book = python_calamine.load_workbook(io.BytesIO(data))
        grids = [book.get_sheet_by_name(name) for name in book.sheet_names]
    except (python_calamine.CalamineError, OSError, ValueError) as error:
        said = say("The file is not a spreadsheet that can be read: {error}.", error=error)
        raise DefectiveInputError("unreadable_file", said) from error
    for grid in grids:
        if grid.total_height > MOST_ROWS or grid.total_width > MOST_COLUMNS:
            said = say("Sheet '{name}' has too many rows or columns for a list.", name=grid.name)
            raise DefectiveInputError("too_large", said)
    for grid in grids:
        yield _sheet([[_as_text(c) for c in row] for row in grid.iter_rows()], columns, grid.start)


def _sheet(
    rows: list[list[str]], columns: Sequence[Column], start: tuple[int, int] | None
) -> Sheet:
    above = start[0] if start else 0
    scores = [score_of(row, columns) for row in rows[:HEADER_WITHIN]]
    place = scores.index(max(scores)) if scores else 0
    header = rows[place] if rows else []
    below = (Row(above + i + 1, row) for i, row in enumerate(rows) if i > place)
    return Sheet(header, above + place + 1, [r for r in below if any(map(str.strip, r.fields))])


def _as_text(cell: Any) -> str:
    """Return a cell as it would be in a table of text."""
    if isinstance(cell, bool):
        return "ja" if cell else "nee"
    if isinstance(cell, float):
        return f"{cell:.0f}" if cell.is_integer() and abs(cell) < 1e15 else repr(cell)
    if isinstance(cell, dt.datetime):
        midnight = cell.time() == dt.time()
        return cell.date().isoformat() if midnight else cell.isoformat(" ", "seconds")
    if isinstance(cell, dt.timedelta):
        return str(cell)
    return str(cell)


def joined(names: Iterable[str]) -> str:
    """Return names in quotes with commas between them."""
    return ", ".join(f"'{name}'" for name in names)
