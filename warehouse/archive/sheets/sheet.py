"""The rows of a table of text or of a spreadsheet, as fields of text with their line.

Titles, blank lines and Excel's `sep=;` above the header are passed over, and so are rows that begin
with `#`. Below the header may be a row of units. What the columns mean is in `lists`; samples are
read faster, in `samples`.
"""

import datetime as dt
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final
from zipfile import BadZipFile

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.files.names import SPREADSHEETS
from warehouse.archive.limits import MOST_LISTED_ROWS, check_extent
from warehouse.archive.sheets.extent import check_workbook
from warehouse.archive.spelling.columns import (
    HEADER_WITHIN,
    Column,
    find_header,
    header_among,
    score_of,
)
from warehouse.archive.spelling.headers import (
    header_of_rows,
    with_units,
)
from warehouse.archive.spelling.text import (
    decode,
    find_delimiter,
    fold,
    shorten,
    split_line,
    split_or_nothing,
)

_HEAD: Final = 100
"""Rows of a sheet in which its header is."""
FEWEST_OF_A_LIST: Final = 4
"""Columns: in a list of that many, a row of one cell is not one of its rows."""


@dataclass(frozen=True)
class Row:
    """One row: its line, its fields, and what is wrong with it as a whole."""

    line: int
    fields: list[str]
    problem: str | None = None


@dataclass(frozen=True)
class Sheet:
    """A table: the cells of its header, the header's line, the rows below it, and its name."""

    header: list[str]
    line: int
    rows: list[Row]
    name: str = ""


@dataclass(frozen=True)
class Grid:
    """The cells of a sheet as text, its name, and how many empty rows are above them."""

    name: str
    above: int
    rows: list[list[str]]


def read_sheets(
    data: bytes,
    columns: Sequence[Column],
    suffix: str = ".csv",
    only: str = "",
    header_lines: tuple[int, int] | None = None,
) -> list[Sheet]:
    """The tables in a file: of a workbook the sheets that name the columns.

    Args:
        data: content of the file.
        columns: the columns that are looked for; the header is the line that names most of them.
        suffix: kind of file, in lower case.
        only: name of the sheet to read; empty for all.
        header_lines: the first and the last line of the header; found when None.

    Raises:
        DefectiveInputError: the file cannot be read, it has no such sheet, or a quotation mark in
            its header is open.
    """
    if suffix in SPREADSHEETS:
        grids = grids_of_workbook(data, columns, only, header_lines)
        return [_sheet(grid, columns, header_lines) for grid in grids]
    lines = decode(data).removeprefix("\ufeff").split("\n")
    lines = [line.rstrip("\r") for line in lines]
    place = header_lines[1] - 1 if header_lines else find_header(lines, columns)
    delimiter = find_delimiter(lines[min(place, len(lines) - 1)])
    above = [split_or_nothing(line, delimiter) for line in lines[: place + 3]]
    header, place = _whole_header(above, place, header_lines)
    rows = [
        _text_row(number, line, delimiter, len(header))
        for number, line in enumerate(lines[place + 1 :], start=place + 2)
    ]
    return [Sheet(header, place + 1, _only_rows(rows, header))]


def _whole_header(
    rows: Sequence[list[str]], place: int, lines: tuple[int, int] | None
) -> tuple[list[str], int]:
    """The header, with the row of units below it, and its last row.

    Args:
        rows: the first rows of the table.
        place: the row that names most columns.
        lines: the lines of the header where these are given, from 1.
    """
    if lines is not None:
        return header_of_rows(rows[lines[0] - 1 : lines[1]]), place
    units = with_units(rows[place], rows[place + 1]) if place + 1 < len(rows) else None
    return (units, place + 1) if units else (rows[place], place)


def _only_rows(rows: Iterable[Row], header: Sequence[str]) -> list[Row]:
    """The rows that hold something, without remarks behind a `#`."""
    filled = [(row, [cell.strip() for cell in row.fields if cell.strip()]) for row in rows]
    kept = [(row, cells) for row, cells in filled if cells and not cells[0].startswith("#")]
    if len(header) < FEWEST_OF_A_LIST:
        return [row for row, _ in kept]
    return [_as_heading(row, cells[0]) if len(cells) == 1 else row for row, cells in kept]


def _as_heading(row: Row, cell: str) -> Row:
    said = say(
        "there is only '{text}' in this row. A heading or a remark may begin with #.",
        text=shorten(cell),
    )
    return replace(row, problem=row.problem or said)


def _text_row(number: int, line: str, delimiter: str, width: int) -> Row:
    """Reads line by line: a quotation mark left open would swallow the rows below."""
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


def grids_of_workbook(
    data: bytes,
    columns: Sequence[Column],
    only: str = "",
    header_lines: tuple[int, int] | None = None,
    most_rows: int = MOST_LISTED_ROWS,
) -> list[Grid]:
    """The cells of the sheets of a workbook that name the columns, or of one of them.

    A sheet that names less than half as many columns as the best is about something else. Only
    where there are several has each its name.

    Args:
        data: content of the file.
        columns: the columns that are looked for.
        only: name of the sheet to read; empty for all.
        header_lines: the first and the last line of the header; found when None.
        most_rows: of a sheet.

    Raises:
        DefectiveInputError: the file cannot be read, or it has no such sheet.
    """
    import python_calamine  # noqa: PLC0415 - only where there is a spreadsheet

    try:
        check_workbook(data, only, most_rows)
        book = python_calamine.load_workbook(io.BytesIO(data))
        names = [name for name in book.sheet_names if not only or fold(name) == fold(only)]
        sheets = [book.get_sheet_by_name(name) for name in names]
    except (python_calamine.CalamineError, BadZipFile, OSError, ValueError) as error:
        said = say("The file is not a spreadsheet that can be read: {error}.", error=error)
        raise DefectiveInputError("unreadable_file", said) from error
    if only and not sheets:
        known = ", ".join(f"'{name}'" for name in book.sheet_names)
        said = say("The workbook has no sheet '{name}'; it has {names}.", name=only, names=known)
        raise DefectiveInputError("unreadable_file", said)
    for sheet in sheets:
        check_extent(sheet.total_height, sheet.total_width, most_rows)
    grids = [Grid(s.name, s.start[0] if s.start else 0, _cells_of(s)) for s in sheets]
    heads = [_sheet(replace(g, rows=g.rows[:_HEAD]), columns, header_lines) for g in grids]
    scores = [score_of(head.header, columns) for head in heads]
    kept = [g for g, score in zip(grids, scores, strict=True) if 2 * score >= max(*scores, 1)]
    return kept if len(kept) > 1 else [replace(grid, name="") for grid in kept or grids[:1]]


def _cells_of(grid: Any) -> list[list[str]]:
    """The cells of a sheet as text; what is in merged cells is in each of them."""
    rows = [[_as_text(cell) for cell in row] for row in grid.iter_rows()]
    top, left = grid.start or (0, 0)
    for (first_row, first), (last_row, last) in grid.merged_cell_ranges or ():
        if first_row == last_row and last - first + 1 >= len(rows[0]) - 1:
            continue  # a title over the table
        for row in rows[first_row - top : last_row - top + 1]:
            row[first - left : last - left + 1] = [rows[first_row - top][first - left]] * (
                last - first + 1
            )
    return rows


def _sheet(grid: Grid, columns: Sequence[Column], header_lines: tuple[int, int] | None) -> Sheet:
    above, rows = grid.above, grid.rows
    if not rows:
        return Sheet([], above + 1, [])
    lines = (max(1, header_lines[0] - above), header_lines[1] - above) if header_lines else None
    place = lines[1] - 1 if lines else header_among(rows[:HEADER_WITHIN], columns)
    header, place = _whole_header(rows, place, lines)
    below = (Row(above + i + 1, row) for i, row in enumerate(rows) if i > place)
    return Sheet(header, above + place + 1, _only_rows(below, header), grid.name)


def _as_text(cell: object) -> str:
    """A cell as it would be in a table of text."""
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
