"""One row of a list, and the values in its cells."""

import datetime as dt
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Final, TypeVar

import polars as pl

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.messages import innermost, say
from pipeline.tables.declare import dy
from pipeline.tables.frames import column_of, limits
from warehouse.archive.faults import at_line
from warehouse.archive.spelling.columns import Column, FoundColumn
from warehouse.archive.spelling.dates import AmbiguousDateError, parse_date
from warehouse.archive.spelling.numbers import THOUSAND, WITH_UNIT, parse_number, ungrouped
from warehouse.archive.spelling.synonyms import CLASSES, HEADERS, NO, YES
from warehouse.archive.spelling.text import fold, fold_word, shorten
from warehouse.archive.spelling.units import UNITS, Scale, find_scale

T = TypeVar("T")

ROWS_ARE_EQUAL: Final = say("the rows are equal and the first counts.")
ROWS_DIFFER: Final = say("the rows differ, so neither counts.")
"""What becomes of rows that are about the same thing."""

BOAT_NUMBER: Final = re.compile(
    r"(?:fsn)?[\s._-]*(?:(?:nr|no|nummer|number|n°|nº)[\s.:_-]*)?([0-9]{1,6}[a-z]?)", re.IGNORECASE
)
_RUN: Final = re.compile(r"(b?)([1-9][0-9]?)", re.IGNORECASE)


@dataclass(frozen=True)
class Reading:
    """What the rows of one list share.

    Attributes:
        columns: the columns found in the header.
        reason_code: what a bad value in this list is called.
        words: the value that a folded word stands for.
        date_order: `dmy` or `mdy` where dates with slashes are settled, else empty.
        decimal: the decimal marks that this list surely uses, comma, point, or both.
        is_told: `archief.toml` says which mark that is.
        table: declares the type and the limits of each value.
        sheet: the sheet, where a workbook has several.
        known: the values of cells that were read, or what is wrong with them, by column and
            spelling.
    """

    columns: Mapping[str, FoundColumn]
    reason_code: str
    words: Mapping[str, str]
    date_order: str
    decimal: str
    table: type[dy.Schema]
    sheet: str = ""
    is_told: bool = False
    known: dict[tuple[str, str | None], Any] = field(default_factory=dict)


@dataclass(frozen=True)
class ListRow:
    """One row of a list; its values are read by name.

    Every method raises `DefectiveInputError` with the row's reason code and line when the value
    cannot be read, lies outside the limits, or is empty although `required`.

    Attributes:
        line: line in the file on which the row begins.
        cells: text by column key, trimmed, words replaced by what they stand for.
        reading: what the rows of the list share.
        row_problem: what is wrong with the row as a whole, e.g. too few fields.
    """

    line: int
    cells: dict[str, str]
    reading: Reading
    row_problem: str | None

    @property
    def columns(self) -> Mapping[str, FoundColumn]:
        """The columns found in the header."""
        return self.reading.columns

    def fault(self, message: str, reason_code: str | None = None) -> DefectiveInputError:
        """The error for this row."""
        if self.reading.sheet:
            message = say("sheet '{sheet}': {what}", sheet=self.reading.sheet, what=message)
        said = at_line(self.line, message)
        return DefectiveInputError(reason_code or self.reading.reason_code, said, self.line)

    def wrong(
        self, message: str, key: str, reason_code: str | None = None, **values: object
    ) -> DefectiveInputError:
        """The error for a cell; the message may have `{column}` and `{cell}` in it."""
        cell = shorten(self.cells.get(key, ""))
        said = say(message, column=self.named(key), cell=cell, **values)
        return self.fault(said, reason_code)

    def check_whole(self) -> None:
        """Raises when something is wrong with the row as a whole."""
        if self.row_problem is not None:
            raise self.fault(self.row_problem)

    def optional_text(self, key: str) -> str | None:
        """The text of a cell, None when it is empty."""
        return self.cells.get(key) or None

    def text(self, key: str) -> str:
        """The text of a cell that must not be empty."""
        return self._there(key, self.optional_text(key))

    def _there(self, key: str, value: T | None) -> T:
        """The value of a cell that must not be empty."""
        if value is None:
            raise self.fault(say("column '{column}' is empty.", column=self.named(key)))
        return value

    def optional_number(self, key: str) -> float | None:
        """A number in SI units within the limits, None when the cell is empty."""
        cell = self.optional_text(key)
        if cell is None:
            return None
        digits, scale = self._digits_and_scale(key, cell)
        value = scale.to_si(parse_number(digits))
        lowest, highest = limits(self.reading.table, key)
        if THOUSAND.fullmatch(digits):
            thousands = scale.to_si(1000 * parse_number(digits))
            if lowest <= thousands <= highest:
                value = value if self._is_in_ones(key, digits, value) else thousands
        if not lowest <= value <= highest:
            low, high = (scale.from_si(limit) for limit in (lowest, highest))
            message = say("column '{column}' is {cell}; {low:g} to {high:g} can be right.")
            raise self.wrong(message, key, low=low, high=high)
        return value

    def _digits_and_scale(self, key: str, cell: str) -> tuple[str, Scale]:
        """The number in a cell and its scale: its own unit goes before the header's."""
        column = self.columns[key]
        own = WITH_UNIT.fullmatch(cell)
        if own and not UNITS[column.dimension] and is_own_unit(key, column.dimension, own[2]):
            cell, own = own[1], None
        scale = find_scale(column.dimension, own[2]) if own and UNITS[column.dimension] else None
        try:
            digits = ungrouped(own[1] if own and scale else cell)
            parse_number(digits)
        except ValueError as error:
            message = say("column '{column}' is '{cell}', which is not an ordinary number.")
            raise self.wrong(message, key) from error
        return digits, scale or column.scale

    def _is_in_ones(self, key: str, cell: str, value: float) -> bool:
        """Whether 1.140 is little more than one, where 1140 can be right as well.

        Raises where both can be right and this list writes its decimals with the other mark.
        """
        lowest, highest = limits(self.reading.table, key)
        if not lowest <= value <= highest:
            return False
        mark = "," if "," in cell else "."
        if self.reading.decimal in {"", mark}:
            return True
        if self.reading.is_told:
            return False
        other = self.reading.decimal.replace(mark, "")
        said = say(
            "column '{column}' is {cell}, while other numbers of this list have their decimals "
            "behind a '{mark}'; write {whole} or {decimal}.",
            column=self.named(key),
            cell=cell,
            mark=other,
            whole=cell.replace(mark, ""),
            decimal=cell.replace(mark, other),
        )
        raise self.fault(said, "ambiguous_number")

    def number(self, key: str) -> float:
        """A number that must be there."""
        return self._there(key, self.optional_number(key))

    def optional_integer(self, key: str) -> int | None:
        """A whole number, None when the cell is empty."""
        value = self.optional_number(key)
        if value is None:
            return None
        if value != int(value):
            raise self.wrong("column '{column}' is {cell}; it must be a whole number.", key)
        return int(value)

    def optional_date(self, key: str) -> dt.date | None:
        """A date, None when the cell is empty."""
        cell = self.optional_text(key)
        if cell is None:
            return None
        try:
            return parse_date(cell, self.reading.date_order)
        except AmbiguousDateError as error:
            message = say(
                "column '{column}' is '{cell}': is the first number the day or the month?"
            )
            raise self.wrong(message, key, "ambiguous_date") from error
        except ValueError as error:
            message = say(
                "column '{column}' is '{cell}', not a date such as 2014-03-01 or 01-03-2014."
            )
            raise self.wrong(message, key) from error

    def date(self, key: str) -> dt.date:
        """A date that must be there."""
        return self._there(key, self.optional_date(key))

    def check_year(self, day: dt.date, year: int, reason_code: str | None = None) -> None:
        """Raises where a day is not in the year of the list."""
        if day.year != year:
            message = say("the date {day} is not in {season}, the year of the list.")
            raise self.fault(say(message, day=day, season=year), reason_code)

    def run(self, key: str) -> int:
        """The number of a run: 1 to 20, or 21 to 40 for b1 to b20."""
        return run_number(self.text(key), self, key, range(1, MOST_RUNS + 1))

    def optional_crew_class(self, key: str) -> str | None:
        """`H` or `D`, None when the cell is empty."""
        cell = self.optional_text(key)
        value = CLASSES.get(fold_word(cell or ""))
        if cell is not None and value is None:
            message = say("column '{column}' is '{cell}'; H or D is expected.")
            raise self.wrong(message, key, choices="H, D")
        return value

    def yes_or_no(self, key: str) -> bool:
        """Whether a cell says yes; an empty one says no."""
        cell = fold_word(self.optional_text(key) or "nee")
        if cell in YES or cell in NO:
            return cell in YES
        raise self.wrong(
            "column '{column}' is '{cell}', not ja, nee or empty.", key, choices="ja, nee"
        )

    def boat(self, key: str) -> str:
        """The number of a boat: `FSN 101`, `fsn nr 101` and `101` are FSN101."""
        cell = self.text(key)
        number = BOAT_NUMBER.fullmatch(cell.strip())
        return f"FSN{number[1].upper()}" if number else cell

    def value(self, column: Column) -> Any:
        """The value of a cell, of the type that the table of the list declares.

        It is None where the cell is empty, which it may be if the table or the header can do
        without the column.
        """
        spelling, known = (column.key, self.cells.get(column.key)), self.reading.known
        if spelling not in known:
            try:
                known[spelling] = self._read(column)
            except DefectiveInputError as error:
                known[spelling] = error
                raise
        value = known[spelling]
        if isinstance(value, DefectiveInputError):
            raise self.fault(innermost(value.message), value.reason_code)
        return value

    def _read(self, column: Column) -> Any:
        declared = column_of(self.reading.table, column.key)
        read = _READERS_BY_KEY.get(column.key) or _READERS[declared.dtype.base_type()]
        value = read(self, column.key)
        may_be_empty = declared.nullable or not column.required
        return value if may_be_empty else self._there(column.key, value)

    def values(self, columns: Iterable[Column]) -> dict[str, Any]:
        """The values of cells; one that cannot be read does not hide the others."""
        return all_of({column.key: partial(self.value, column) for column in columns})

    def named(self, key: str) -> str:
        """What the file calls a column."""
        place = self.columns.get(key)
        return place.header if place else key


_READERS_BY_KEY: Final[Mapping[str, Callable[[ListRow, str], object]]] = {
    "fsn_no": ListRow.boat,
    "crew_class": ListRow.optional_crew_class,
    "run": ListRow.run,
}
_READERS: Final[Mapping[type[pl.DataType], Callable[[ListRow, str], object]]] = {
    pl.String: ListRow.optional_text,
    pl.Float64: ListRow.optional_number,
    **dict.fromkeys((pl.Int8, pl.Int16, pl.Int32), ListRow.optional_integer),
    pl.Date: ListRow.optional_date,
    pl.Boolean: ListRow.yes_or_no,
}


class DefectiveRowError(DefectiveInputError):
    """A row in which several values are wrong: the first, and with it the others."""

    def __init__(self, faults: Sequence[DefectiveInputError]) -> None:
        first = faults[0]
        super().__init__(first.reason_code, first.message, first.line)
        self.others = tuple(faults[1:])


def all_of(readings: Mapping[str, Callable[[], Any]]) -> dict[str, Any]:
    """What each of these reads; one that cannot be read does not hide the others.

    Raises:
        DefectiveRowError: the first fault, with the others.
    """
    values: dict[str, Any] = {}
    faults: list[DefectiveInputError] = []
    for key, reading in readings.items():
        try:
            values[key] = reading()
        except DefectiveInputError as error:
            faults += [error, *others_of(error)]
    if faults:
        raise DefectiveRowError(faults)
    return values


def others_of(error: BaseException) -> tuple[DefectiveInputError, ...]:
    """What else is wrong in the row of a fault."""
    return error.others if isinstance(error, DefectiveRowError) else ()


def run_number(part: str, row: ListRow, header: str, planned: Collection[int]) -> int:
    """The number of a run as written in a list: 1 and on, or 21 and on for b1 and on.

    Raises:
        DefectiveInputError: it is not one, with the row's reason code and line.
    """
    match = _RUN.fullmatch(part)
    if match is None or int(match[2]) not in planned:
        raise row.fault(
            say(
                "column '{column}' has '{part}'; runs are 1 to {last}, or b1 to b{last} for the "
                "second file, with commas between them. Runs beyond these need a [[plan]].",
                column=header,
                part=shorten(part),
                last=max(planned),
            )
        )
    return int(match[2]) + (SECOND_FILE_OFFSET if match[1] else 0)


def is_own_unit(key: str, dimension: str, text: str) -> bool:
    """Whether a text behind a number is a unit, or says what is counted: `8 roeiers`."""
    names = HEADERS.get(key, ()) if dimension == "none" else ()
    return find_scale(dimension, text) is not None or fold(text) in map(fold, names)
