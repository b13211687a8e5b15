"""Reading a list: a small table of text with one header, and the values in its rows.

What the columns of the tow list, the boat list, a register or race results mean stands in the
modules that read those.
"""

import datetime as dt
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.text import (
    Column,
    FoundColumn,
    decode,
    find_columns,
    find_delimiter,
    parse_number,
    shorten,
    split_line,
)

_ISO_DATE: Final = re.compile(r"([0-9]{4})-([0-9]{2})-([0-9]{2})")
_DUTCH_DATE: Final = re.compile(r"([0-9]{1,2})-([0-9]{1,2})-([0-9]{4})")
_CLASSES: Final = {"h": "H", "d": "D"}


@dataclass(frozen=True)
class ListRow:
    """One row of a list; its values are read by name.

    Every method raises `DefectiveInputError` with the row's reason code and line when the value
    cannot be read, lies outside the limits, or is empty although `required`.

    Attributes:
        line: line in the file on which the row begins.
        cells: text by column key, trimmed.
        columns: the columns found in the header.
        reason_code: what a bad value in this list is called.
        row_problem: what is wrong with the row as a whole, e.g. too few fields.
    """

    line: int
    cells: dict[str, str]
    columns: dict[str, FoundColumn]
    reason_code: str
    row_problem: str | None

    def fault(self, message: str) -> DefectiveInputError:
        """Return the error for this row."""
        return DefectiveInputError(self.reason_code, f"Line {self.line}: {message}", self.line)

    def check_whole(self) -> None:
        """Raise when something is wrong with the row as a whole."""
        if self.row_problem is not None:
            raise self.fault(self.row_problem)

    def optional_text(self, key: str) -> str | None:
        """Return the text of a cell, None when it is empty."""
        return self.cells.get(key) or None

    def text(self, key: str) -> str:
        """Return the text of a cell that must not be empty."""
        value = self.optional_text(key)
        if value is None:
            raise self.fault(f"{self._named(key)} is empty.")
        return value

    def optional_number(self, key: str, lowest: float, highest: float) -> float | None:
        """Return a number in SI units within the limits, None when the cell is empty."""
        cell = self.optional_text(key)
        if cell is None:
            return None
        try:
            number = parse_number(cell)
        except ValueError as error:
            raise self.fault(f"{self._named(key)}: {error}.") from error
        numerator, denominator = self.columns[key].scale
        value = number * numerator / denominator
        if not lowest <= value <= highest:
            limits = (limit * denominator / numerator for limit in (lowest, highest))
            low, high = (f"{limit:g}" for limit in limits)
            raise self.fault(f"{self._named(key)} is {cell}; {low} to {high} can be right.")
        return value

    def number(self, key: str, lowest: float, highest: float) -> float:
        """Return a number that must be there."""
        self.text(key)
        value = self.optional_number(key, lowest, highest)
        assert value is not None  # noqa: S101 - the cell is not empty
        return value

    def optional_integer(self, key: str, lowest: int, highest: int) -> int | None:
        """Return a whole number, None when the cell is empty."""
        value = self.optional_number(key, lowest, highest)
        if value is None:
            return None
        if value != int(value):
            raise self.fault(f"{self._named(key)} is {self.cells[key]}; it must be whole.")
        return int(value)

    def integer(self, key: str, lowest: int, highest: int) -> int:
        """Return a whole number that must be there."""
        self.text(key)
        value = self.optional_integer(key, lowest, highest)
        assert value is not None  # noqa: S101 - the cell is not empty
        return value

    def optional_date(self, key: str) -> dt.date | None:
        """Return a date (`2014-03-01` or `01-03-2014`), None when the cell is empty."""
        cell = self.optional_text(key)
        if cell is None:
            return None
        try:
            return parse_date(cell)
        except ValueError as error:
            raise self.fault(f"{self._named(key)}: {error}.") from error

    def date(self, key: str) -> dt.date:
        """Return a date that must be there."""
        self.text(key)
        value = self.optional_date(key)
        assert value is not None  # noqa: S101 - the cell is not empty
        return value

    def crew_class(self, key: str) -> str:
        """Return `H` or `D`."""
        value = _CLASSES.get(self.text(key).casefold())
        if value is None:
            raise self.fault(f"{self._named(key)} is '{shorten(self.cells[key])}', not H or D.")
        return value

    def _named(self, key: str) -> str:
        found = self.columns.get(key)
        return f"column '{found.header if found else key}'"


def parse_date(text: str) -> dt.date:
    """Return the date written as `2014-03-01` or `01-03-2014`.

    Raises:
        ValueError: it is no such date.
    """
    iso = _ISO_DATE.fullmatch(text)
    dutch = _DUTCH_DATE.fullmatch(text)
    try:
        if iso:
            return dt.date(int(iso[1]), int(iso[2]), int(iso[3]))
        if dutch:
            return dt.date(int(dutch[3]), int(dutch[2]), int(dutch[1]))
    except ValueError:
        pass
    raise ValueError(f"'{shorten(text)}' is not a date such as 2014-03-01 or 01-03-2014")


def read_rows(data: bytes, columns: Sequence[Column], reason_code: str) -> list[ListRow]:
    """Return the rows of a list; empty ones are left out.

    Args:
        data: content of the file.
        columns: the columns to look for.
        reason_code: what a bad value in this list is called.

    Raises:
        DefectiveInputError: the list as a whole cannot be read.
    """
    header_line, *lines = decode(data).split("\n")
    delimiter = find_delimiter(header_line)
    header = split_line(header_line.rstrip("\r"), delimiter)
    found = find_columns(header, columns)
    rows = (
        _read_row(number, line.rstrip("\r"), delimiter, len(header))
        for number, line in enumerate(lines, start=2)
    )
    return [
        _row(number, fields, problem, found, reason_code)
        for number, fields, problem in rows
        if any(field.strip() for field in fields)
    ]


def _read_row(
    number: int, line: str, delimiter: str, width: int
) -> tuple[int, list[str], str | None]:
    """Return line number, fields and what is wrong with the row as a whole.

    Line by line, as a quotation mark that is not closed would otherwise swallow the rows below.
    """
    try:
        fields = split_line(line, delimiter)
    except DefectiveInputError:
        return number, line.split(delimiter), "a quotation mark is not closed, or in mid-field."
    if len(fields) < width or any(field.strip() for field in fields[width:]):
        return number, fields, f"the row has {len(fields)} fields where the header has {width}."
    return number, fields, None


def _row(
    line: int,
    fields: list[str],
    problem: str | None,
    found: dict[str, FoundColumn],
    reason_code: str,
) -> ListRow:
    cells = {
        key: fields[column.index].strip()
        for key, column in found.items()
        if column.index < len(fields)
    }
    return ListRow(line, cells, found, reason_code, problem)
