"""Reading samples from text.

There are two ways: a fast one that polars does whole, and a careful one that knows lines; the fast
one is trusted only where it gives the same.
"""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.files.contents import read_bytes, read_start
from warehouse.archive.files.names import SPREADSHEETS, kind_of, split_sheet
from warehouse.archive.limits import MOST_ROWS_OF_A_SHEET, SAMPLES_MAX_BYTES
from warehouse.archive.profile.season import SeasonProfile
from warehouse.archive.samples.columns import check_nothing_misspelt, seconds_of_clock, to_si
from warehouse.archive.samples.labview import is_labview, labview_as_table
from warehouse.archive.sheets.sheet import Grid, grids_of_workbook
from warehouse.archive.spelling.columns import (
    FoundColumn,
    find_columns,
    find_header,
    score_of,
)
from warehouse.archive.spelling.headers import header_of_rows, with_units
from warehouse.archive.spelling.numbers import NUMBER_PATTERN
from warehouse.archive.spelling.text import decode, find_delimiter, split_line
from warehouse.archive.spelling.units import Scale

_BLANKS: Final = " \t"
_BLANKS_OUTSIDE: Final = re.compile(rb"^[ \t]+|[ \t]+(?=\r?$)", re.MULTILINE)
_BLANKS_WITHIN: Final = re.compile(rb"[ \t]+")
_RUN_NAMED: Final = r"(?i)^(?:run|vaart|lauf|passage)[ \t._:-]*([0-9]{1,2})$"
"""A run with its number behind the word: `run 1`."""
HEAD_BYTES: Final = 65_536
"""The header is looked for in so much of a file."""
_QUOTED_DECIMAL_COMMA: Final = r'"([ \t]*[+-]?[0-9]*),([0-9][0-9eE+ \t-]*)"'
_THOUSAND: Final = {
    ",": r"^[+-]?[0-9]{1,3},[0-9]{3}$",
    ".": r"^[+-]?[0-9]{1,3}\.[0-9]{3}$",
}


@dataclass(frozen=True)
class Lines:
    """Lines in a file: of its header, and of its rows; `places` where these do not follow on."""

    header: int
    first: int
    places: Sequence[int] = ()

    def __call__(self, row: int) -> int:
        """Line in the file of a row, counted from 0; of the header where it is negative."""
        if row < 0:
            return self.header
        return self.places[row] if row < len(self.places) else self.first + row


class Body(NamedTuple):
    """The text below the header, and what the header says of it."""

    data: bytes
    delimiter: str
    header: Sequence[str]
    columns: Mapping[str, FoundColumn]
    line_of: Lines


def body_of(path: Path, profile: SeasonProfile, start: int | None = None) -> Body:
    """The body of a file of text or of a sheet, or of so many bytes at its start.

    Raises:
        DefectiveInputError: the file cannot be read, or a fault of its header.
    """
    if kind_of(path) in SPREADSHEETS:
        return find_body(_sheet_as_text(path, profile), profile)
    data = read_bytes(path, SAMPLES_MAX_BYTES) if start is None else read_start(path, start)
    return find_body(data, profile)


def sheets_with_samples(path: Path, profile: SeasonProfile) -> list[str]:
    """The names of the sheets of a workbook that hold samples, where it has several."""
    return [grid.name for grid in _grids(path, profile) if grid.name]


def _grids(path: Path, profile: SeasonProfile) -> list[Grid]:
    file, sheet = split_sheet(str(path))
    data = read_bytes(Path(file), SAMPLES_MAX_BYTES)
    lines = profile.header_lines
    return grids_of_workbook(data, profile.columns, sheet, lines, MOST_ROWS_OF_A_SHEET)


def _sheet_as_text(path: Path, profile: SeasonProfile) -> bytes:
    """A sheet as lines with tabs, each with the number of its row."""
    grid = _grids(path, profile)[0]
    rows = ("\t".join(" ".join(cell.split()) for cell in row) for row in grid.rows)
    return "\n".join([*[""] * grid.above, *rows, ""]).encode()


def read_text(body: Body) -> pl.DataFrame:
    """The wanted columns as Float64, in SI units; an absent or empty gps is left out."""
    fast = _read_fast(body)
    columns = _read_carefully(body) if fast is None else fast
    return to_si(columns, body.columns)


def find_body(data: bytes, profile: SeasonProfile) -> Body:
    """Finds the header, below titles if there are any, and what it says of the columns."""
    if not data.isascii() or b"\x00" in data or not data[:100].strip():
        data = unicodedata.normalize("NFC", decode(data)).encode()
    is_in_segments = is_labview(data)
    if is_in_segments:
        data = labview_as_table(data)
    lines = data[:HEAD_BYTES].decode(errors="ignore").split("\n")
    told = profile.header_lines
    place = min(told[1], len(lines)) - 1 if told else find_header(lines, profile.columns)
    header_line, below = lines[place].rstrip("\r"), place + 1
    if profile.header is not None and not score_of(
        split_line(header_line, find_delimiter(header_line)), profile.columns
    ):
        header_line, below = profile.header, place
    delimiter = find_delimiter(lines[place])
    header = split_line(header_line, find_delimiter(header_line))
    if told:
        header = header_of_rows([split_line(x, delimiter) for x in lines[told[0] - 1 : told[1]]])
    elif units := with_units(header, _cells_of_line(lines, below, delimiter)):
        header, below = units, below + 1
    columns = find_columns(header, profile.columns, place + 1)
    check_nothing_misspelt(header, columns, profile)
    data = data[_start_of_line(data, below) :]
    if not data.strip(b"\r\n"):
        said = say("There are no samples below the header.")
        raise DefectiveInputError("unreadable_file", said)
    if delimiter == " ":
        data, delimiter = _BLANKS_WITHIN.sub(b"\t", _BLANKS_OUTSIDE.sub(b"", data)), "\t"
    rows: list[int] = []
    if is_in_segments or not {"run", "time"} & columns.keys():
        run_behind = None if "run" in columns else delimiter.encode()
        data, rows = _without_blank_lines(data, delimiter, run_behind)
        if rows and run_behind:
            columns = {**columns, "run": FoundColumn(len(header), "run", Scale())}
            header = [*header, "run"]
    line_of = Lines(place + 1, below + 1, [below + 1 + row for row in rows])
    return Body(data, delimiter, header, columns, line_of)


def _without_blank_lines(
    data: bytes, delimiter: str, run_behind: bytes | None
) -> tuple[bytes, list[int]]:
    """The rows, each with the number of its run behind it where that is asked; and their places.

    A run is what is between blank lines: in a file without a column of runs or times nothing else
    can be meant by them. Where there are none between rows, the data are as they were.
    """
    nothing = delimiter.encode() + b" \t\r"
    lines = data.split(b"\n")
    places = np.flatnonzero([bool(line.strip(nothing)) for line in lines])
    begins = np.diff(places, prepend=places[:1]) > 1
    if not begins.any():
        return data, []
    rows = [lines[place].rstrip(b"\r") for place in places]
    if run_behind:
        runs = (1 + np.cumsum(begins)).tolist()
        rows = [row + run_behind + str(run).encode() for row, run in zip(rows, runs, strict=True)]
    return b"\n".join([*rows, b""]), places.tolist()


def _cells_of_line(lines: Sequence[str], number: int, delimiter: str) -> list[str]:
    """The cells of a line that may not be a row of samples; none where there is no line."""
    if number >= len(lines) or any(map(str.isdigit, lines[number])):
        return []
    return lines[number].split(None if delimiter == " " else delimiter)


def _start_of_line(data: bytes, number: int) -> int:
    """Place of the first byte of a line, counted from 0."""
    start = 0
    for _ in range(number):
        start = data.find(b"\n", start) + 1 or len(data)
    return start


def _read_fast(body: Body) -> pl.DataFrame | None:
    """The columns, or None where the careful way has to judge.

    That is where cells are quoted or hold a time of day; where a carriage return is within a line:
    Polars takes it for a blank; and where there are commas and points: Polars takes either for the
    decimal mark.
    """
    data = body.data
    is_mixed = body.delimiter != "," and b"," in data and b"." in data
    is_returning = b"\r" in data and data.count(b"\r") != data.count(b"\r\n")
    if is_mixed or is_returning or b'"' in data:
        return None
    wanted = {column.index: key for key, column in body.columns.items()}
    schema = {
        wanted.get(index, f"ignored {index}"): pl.Float64() if index in wanted else pl.String()
        for index in range(len(body.header))
    }
    try:
        frame = pl.read_csv(
            data,
            has_header=False,
            separator=body.delimiter,
            quote_char=None,
            decimal_comma=body.delimiter != ",",
            schema=schema,
        ).select(wanted.values())
    except pl.exceptions.PolarsError:
        return None
    return frame if all(map(_all_finite, frame.iter_columns())) else None


def _all_finite(numbers: pl.Series) -> bool:
    """Whether every cell holds a number; NumPy is quicker at it than Polars."""
    return numbers.null_count() == 0 and bool(np.isfinite(numbers.to_numpy()).all())


def _read_carefully(body: Body) -> pl.DataFrame:
    """The same columns, NaN where a cell is not a number or its row has not all its fields."""
    text = body.data.rstrip(b"\r\n").decode()
    lines = pl.Series("line", text.split("\n")).str.strip_suffix("\r")
    if body.delimiter == ",":
        lines = lines.str.replace_all(_QUOTED_DECIMAL_COMMA, '"$1.$2"')
    fields = lines.str.split(body.delimiter)
    whole = fields.list.len() == len(body.header)
    columns: dict[str, pl.Series] = {}
    for key, column in body.columns.items():
        cells = fields.list.get(column.index, null_on_oob=True)
        cells = cells.str.strip_chars(_BLANKS).str.replace(r'^"([^"]*)"$', "$1")
        cells = cells.str.strip_chars(_BLANKS)
        if key == "gps" and (cells == "").all():
            continue
        if key == "run":
            cells = cells.str.replace(_RUN_NAMED, "$1")
        if key == "time":
            cells = seconds_of_clock(cells).cast(pl.String()).fill_null(cells)
        columns[key] = _to_numbers(cells, whole)
    return pl.DataFrame(columns)


def _to_numbers(cells: pl.Series, whole: pl.Series) -> pl.Series:
    """Text as numbers; NaN where it is not one or the row is not whole.

    In a column of decimal commas 1.012 can be a thousand and twelve: it is not a number either, nor
    is 1,012 among points.
    """
    spelled = cells.str.contains(NUMBER_PATTERN)
    commas, points = (cells.str.contains(mark, literal=True).sum() for mark in ",.")
    for mark, rarer in ((",", commas <= points), (".", points <= commas)):
        if commas and points and rarer:
            spelled &= ~cells.str.contains(_THOUSAND[mark])
    numbers = cells.str.replace(",", ".", literal=True).cast(pl.Float64(), strict=False)
    good = (spelled & whole & numbers.is_finite()).fill_null(value=False)
    return pl.select(pl.when(good).then(numbers).otherwise(float("nan"))).to_series()
