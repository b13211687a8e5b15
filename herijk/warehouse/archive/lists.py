"""Reading a list: a small table of text with one header, and the values in its rows.

What the columns of the tow list, the boat list, a register or race results mean is in the
modules that read those.
"""

import datetime as dt
import re
import unicodedata
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Final, TypeVar

import polars as pl

from herijk.pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from herijk.pipeline.errors import DefectiveInputError
from herijk.tables.declare import dy
from herijk.tables.frames import frame_of, limits
from herijk.tables.row import Row
from herijk.warehouse.archive.crews import CREW, with_crews_apart
from herijk.warehouse.archive.faults import Fault, at_line, fault_from
from herijk.warehouse.archive.files import list_files, path_inside, read_bytes
from herijk.warehouse.archive.kinds import ListKind
from herijk.warehouse.archive.limits import LIST_MAX_BYTES
from herijk.warehouse.archive.meaning import Meaning, meanings
from herijk.warehouse.archive.misfits import misfits
from herijk.warehouse.archive.sheets import Sheet, read_sheets, split_sheet
from herijk.warehouse.archive.text import (
    Column,
    FoundColumn,
    find_columns,
    fold,
    fold_word,
    parse_number,
    shorten,
    unknown_headers,
)
from herijk.warehouse.archive.units import UNITS, Scale, find_scale
from herijk.warehouse.archive.words import ALL_RUNS, CLASSES, HEADERS, NO, NOTHING, YES
from herijk.words import say

T = TypeVar("T")

ROWS_ARE_EQUAL: Final = "the rows are equal and the first counts."
ROWS_DIFFER: Final = "the rows differ, so neither counts."
"""What becomes of rows that are about the same thing."""

_ISO_DATE: Final = re.compile(r"([0-9]{4})[-/.]([0-9]{1,2})[-/.]([0-9]{1,2})")
_DAY_FIRST: Final = re.compile(r"([0-9]{1,2})([-./ ])([0-9]{1,2})\2([0-9]{4}|[0-9]{2})")
_MONTH_NAMED: Final = re.compile(r"([0-9]{1,2})[. -]+([a-zäé]{3,9})[. -]+'?([0-9]{4}|[0-9]{2})")
_SERIAL_DATE: Final = re.compile(r"(?:3[3-9]|4[0-9]|5[0-4])[0-9]{3}")
"""What a spreadsheet shows of a date in a cell that is not set to show dates: 1990 to 2050."""
_EXCEL_DAY_0: Final = dt.date(1899, 12, 30)
_WEEKDAY: Final = re.compile(r"^[a-z]{2,10}[.,]*\s+(?=[0-9])")
_TIME_OF_DAY: Final = re.compile(r"[ T]+[0-9]{1,2}:[0-9]{2}(:[0-9]{2}([.,][0-9]+)?)?$")
_MONTHS: Final = {
    name: number
    for number, names in enumerate(
        ("jan", "feb", "mrt mar maa mär", "apr", "mei may mai", "jun", "jul", "aug", "sep",
         "okt oct", "nov", "dec dez"), start=1
    )
    for name in names.split()
}  # fmt: skip
_GAPS: Final = "'\u2019 \u00a0\u202f"
"""What stands between thousands and never before decimals."""
_WITH_UNIT: Final = re.compile(
    rf"([+-]?[0-9.,]+(?:[{_GAPS}][0-9]{{3}})*(?:[.,][0-9]+)?(?:[eE][+-]?[0-9]+)?)"
    r"\s*([^0-9\s.,+-].*)"
)
_THOUSAND: Final = re.compile(r"[+-]?[1-9][0-9]{0,2}([.,])[0-9]{3}")
_GROUPED: Final = re.compile(
    rf"[+-]?[1-9][0-9]{{0,2}}(?P<mark>[.,{_GAPS}])[0-9]{{3}}(?P<more>(?:(?P=mark)[0-9]{{3}})*)"
    r"(?P<decimals>(?!(?P=mark))[.,][0-9]+)?"
)
_DECIMAL: Final = re.compile(r"[+-]?[0-9]*([.,])([0-9]{1,2}|[0-9]{4,})")
_BOAT: Final = re.compile(
    r"(?:fsn)?[\s._-]*(?:(?:nr|no|nummer|number|n°|nº)[\s.:_-]*)?([0-9]{1,6}[a-z]?)", re.IGNORECASE
)
_RUN: Final = re.compile(r"(b?)([1-9][0-9]?)", re.IGNORECASE)


def ungrouped(cell: str) -> str:
    """Return a number without the marks between its thousands, where they can be nothing else.

    `1.140,50`, `1,234,567`, `1 140` and `1'140` are; `1.140` can be little more than one.
    """
    match = _GROUPED.fullmatch(cell)
    if match is None or not (match["more"] or match["decimals"] or match["mark"] in _GAPS):
        return cell
    return cell.replace(match["mark"], "")


@dataclass(frozen=True)
class Wording:
    """How the lists of an archive are worded, beside what `words` knows: from `archief.toml`.

    Attributes:
        words: the value that a folded word stands for; empty text for nothing.
        headers: the project's name of a column by a folded other one.
        ignore: folded names of columns that are known and not used.
        dates: `dmy` or `mdy` by the path of a list, or `*` for all: how 1/3/2015 is meant.
        decimals: the mark before decimals, `.` or `,`, by the path of a list, or `*` for all.
        files: what a file or folder stands for, by its path in the archive: `sleeplijst_2014`.
    """

    words: Mapping[str, str] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)
    ignore: tuple[str, ...] = ()
    dates: Mapping[str, str] = field(default_factory=dict)
    decimals: Mapping[str, str] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)

    def with_names(self, columns: Iterable[Column]) -> tuple[Column, ...]:
        """Return the columns with the other names that they answer to."""
        return tuple(replace(c, also=(*c.also, *self._names(c))) for c in columns)

    def _names(self, column: Column) -> tuple[str, ...]:
        named = {fold(column.header), column.key}
        own = (n for n, meant in self.headers.items() if fold(meant) in named or meant in named)
        return (*HEADERS.get(column.key, ()), *own)


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
    """

    columns: Mapping[str, FoundColumn]
    reason_code: str
    words: Mapping[str, str]
    date_order: str
    decimal: str
    table: type[dy.Schema]
    sheet: str = ""
    is_told: bool = False


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
        """Return the error for this row."""
        if self.reading.sheet:
            message = say("sheet '{sheet}': {what}", sheet=self.reading.sheet, what=message)
        said = at_line(self.line, message)
        return DefectiveInputError(reason_code or self.reading.reason_code, said, self.line)

    def wrong(
        self, message: str, key: str, reason_code: str | None = None, **values: object
    ) -> DefectiveInputError:
        """Return the error for a cell; the message may have `{column}` and `{cell}` in it."""
        cell = shorten(self.cells.get(key, ""))
        said = say(message, column=self.named(key), cell=cell, **values)
        return self.fault(said, reason_code)

    def check_whole(self) -> None:
        """Raise when something is wrong with the row as a whole."""
        if self.row_problem is not None:
            raise self.fault(self.row_problem)

    def optional_text(self, key: str) -> str | None:
        """Return the text of a cell, None when it is empty."""
        return self.cells.get(key) or None

    def text(self, key: str) -> str:
        """Return the text of a cell that must not be empty."""
        return self._there(key, self.optional_text(key))

    def _there(self, key: str, value: T | None) -> T:
        """Return the value of a cell that must not be empty."""
        if value is None:
            raise self.fault(say("column '{column}' is empty.", column=self.named(key)))
        return value

    def optional_number(self, key: str) -> float | None:
        """Return a number in SI units within the limits, None when the cell is empty."""
        cell = self.optional_text(key)
        if cell is None:
            return None
        digits, scale = self._digits_and_scale(key, cell)
        value = scale.to_si(parse_number(digits))
        lowest, highest = limits(self.reading.table, key)
        if _THOUSAND.fullmatch(digits):
            thousands = scale.to_si(1000 * parse_number(digits))
            if lowest <= thousands <= highest:
                value = value if self._is_in_ones(key, digits, value) else thousands
        if not lowest <= value <= highest:
            low, high = (scale.from_si(limit) for limit in (lowest, highest))
            message = "column '{column}' is {cell}; {low:g} to {high:g} can be right."
            raise self.wrong(message, key, low=low, high=high)
        return value

    def _digits_and_scale(self, key: str, cell: str) -> tuple[str, Scale]:
        """Return the number in a cell and its scale: its own unit goes before the header's."""
        column = self.columns[key]
        own = _WITH_UNIT.fullmatch(cell)
        if own and not UNITS[column.dimension] and _is_own_unit(key, column.dimension, own[2]):
            cell, own = own[1], None
        scale = find_scale(column.dimension, own[2]) if own and UNITS[column.dimension] else None
        try:
            digits = ungrouped(own[1] if own and scale else cell)
            parse_number(digits)
        except ValueError as error:
            message = "column '{column}' is '{cell}', which is not an ordinary number."
            raise self.wrong(message, key) from error
        return digits, scale or column.scale

    def _is_in_ones(self, key: str, cell: str, value: float) -> bool:
        """Return whether 1.140 is little more than one, where 1140 can be right as well.

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
        """Return a number that must be there."""
        return self._there(key, self.optional_number(key))

    def optional_integer(self, key: str) -> int | None:
        """Return a whole number, None when the cell is empty."""
        value = self.optional_number(key)
        if value is None:
            return None
        if value != int(value):
            raise self.wrong("column '{column}' is {cell}; it must be a whole number.", key)
        return int(value)

    def optional_date(self, key: str) -> dt.date | None:
        """Return a date, None when the cell is empty."""
        cell = self.optional_text(key)
        if cell is None:
            return None
        try:
            return parse_date(cell, self.reading.date_order)
        except AmbiguousDateError as error:
            message = "column '{column}' is '{cell}': is the first number the day or the month?"
            raise self.wrong(message, key, "ambiguous_date") from error
        except ValueError as error:
            message = "column '{column}' is '{cell}', not a date such as 2014-03-01 or 01-03-2014."
            raise self.wrong(message, key) from error

    def date(self, key: str) -> dt.date:
        """Return a date that must be there."""
        return self._there(key, self.optional_date(key))

    def check_year(self, day: dt.date, year: int, reason_code: str | None = None) -> None:
        """Raise where a day is not in the year of the list."""
        if day.year != year:
            message = "the date {day} is not in {season}, the year of the list."
            raise self.fault(say(message, day=day, season=year), reason_code)

    def run(self, key: str) -> int:
        """Return the number of a run: 1 to 20, or 21 to 40 for b1 to b20."""
        return run_number(self.text(key), self, key, range(1, MOST_RUNS + 1))

    def optional_crew_class(self, key: str) -> str | None:
        """Return `H` or `D`, None when the cell is empty."""
        cell = self.optional_text(key)
        value = CLASSES.get(fold_word(cell or ""))
        if cell is not None and value is None:
            message = "column '{column}' is '{cell}'; H or D is expected."
            raise self.wrong(message, key, expected="HD")
        return value

    def yes_or_no(self, key: str) -> bool:
        """Return whether a cell says yes; an empty one says no."""
        cell = fold_word(self.optional_text(key) or "nee")
        if cell in YES or cell in NO:
            return cell in YES
        raise self.wrong("column '{column}' is '{cell}', not ja, nee or empty.", key, choice="ja")

    def boat(self, key: str) -> str:
        """Return the number of a boat: `FSN 101`, `fsn nr 101` and `101` are FSN101."""
        cell = self.text(key)
        number = _BOAT.fullmatch(cell.strip())
        return f"FSN{number[1].upper()}" if number else cell

    def value(self, column: Column) -> Any:
        """Return the value of a cell, of the type that the table of the list declares.

        It is None where the cell is empty, which it may be if the table or the header can do
        without the column.
        """
        declared = self.reading.table.columns()[column.key]
        read = _READERS_BY_KEY.get(column.key) or _READERS[declared.dtype.base_type()]
        value = read(self, column.key)
        may_be_empty = declared.nullable or not column.required
        return value if may_be_empty else self._there(column.key, value)

    def values(self, columns: Iterable[Column]) -> dict[str, Any]:
        """Return the values of cells; one that cannot be read does not hide the others."""
        return all_of({column.key: partial(self.value, column) for column in columns})

    def named(self, key: str) -> str:
        """Return what the file calls a column."""
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
    """Return what each of these reads; one that cannot be read does not hide the others.

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


def run_number(part: str, row: ListRow, header: str, planned: Collection[int]) -> int:
    """Return the number of a run as written in a list: 1 and on, or 21 and on for b1 and on.

    Raises:
        DefectiveInputError: it is none, with the row's reason code and line.
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


def others_of(error: DefectiveInputError) -> tuple[DefectiveInputError, ...]:
    """Return what else is wrong in the row of a fault."""
    return error.others if isinstance(error, DefectiveRowError) else ()


class AmbiguousDateError(ValueError):
    """Day and month can be exchanged."""


def parse_date(text: str, order: str = "") -> dt.date:
    """Return the date in a text, the year first or the day first; a time of day is left out.

    Args:
        text: `2014-03-01`, `1-3-2014`, `01.03.14`, `1/3/2014`, `za 1 maart 2014`, `1-mrt-14`,
            or the number of days that a spreadsheet holds.
        order: `dmy` or `mdy` for dates with slashes; without, only one meaning may be possible.

    Raises:
        AmbiguousDateError: day and month can be exchanged.
        ValueError: it is no date.
    """
    text = _WEEKDAY.sub("", _TIME_OF_DAY.sub("", text.strip().casefold()))
    iso, day_first = _ISO_DATE.fullmatch(text), _DAY_FIRST.fullmatch(text)
    named = _MONTH_NAMED.fullmatch(text)
    if iso:
        return dt.date(int(iso[1]), int(iso[2]), int(iso[3]))
    if _SERIAL_DATE.fullmatch(text):
        return _EXCEL_DAY_0 + dt.timedelta(days=int(text))
    if named and named[2][:3] in _MONTHS:
        return dt.date(_year(named[3]), _MONTHS[named[2][:3]], int(named[1]))
    if not day_first:
        raise ValueError(text)
    first, second = int(day_first[1]), int(day_first[3])
    if day_first[2] == "/" and not order and first != second and max(first, second) <= 12:
        raise AmbiguousDateError(text)
    month_first = day_first[2] == "/" and (order == "mdy" or (not order and second > 12))
    day, month = (second, first) if month_first else (first, second)
    return dt.date(_year(day_first[4]), month, day)


def _year(digits: str) -> int:
    return int(digits) + (2000 if len(digits) == 2 else 0)


def date_order(cells: Iterable[str]) -> str:
    """Return `dmy` or `mdy` where dates with slashes in a list can only be meant so, else empty."""
    matches = (_DAY_FIRST.fullmatch(_TIME_OF_DAY.sub("", cell.strip())) for cell in cells)
    pairs = [(int(m[1]), int(m[3])) for m in matches if m and m[2] == "/"]
    orders = {"dmy" for first, _ in pairs if first > 12}
    orders |= {"mdy" for _, second in pairs if second > 12}
    return orders.pop() if len(orders) == 1 else ""


def read_rows(
    data: bytes,
    columns: Sequence[Column],
    reason_code: str,
    table: type[dy.Schema],
) -> list[ListRow]:
    """Return the rows of a table of text that anybody made; other columns are ignored.

    Args:
        data: content of the file.
        columns: the columns to look for.
        reason_code: what a bad value in this table is called.
        table: declares the type and the limits of each value.

    Raises:
        DefectiveInputError: the table as a whole cannot be read.
    """
    sheet = read_sheets(data, columns)[0]
    places = find_columns(sheet.header, columns, sheet.line)
    return _rows(sheet, Reading(places, reason_code, {}, "", "", table))


def read_list(root: Path, kind: ListKind, path: str, wording: Wording) -> list[ListRow]:
    """Return the rows of a list of the archive; empty ones are left out.

    Args:
        root: folder of the archive.
        kind: which list.
        path: the list, relative to the archive.
        wording: how the lists of this archive are worded.

    Raises:
        DefectiveInputError: the list as a whole cannot be read, or has a column that nobody knows:
            it can be a misspelt one, and left out in silence would change numbers.
    """
    data = read_bytes(path_inside(root, path), LIST_MAX_BYTES)
    wanted = wording.with_names(kind.columns)
    file, sheet = split_sheet(path)
    suffix = file[file.rfind(".") :].casefold()
    sheets = [with_crews_apart(s, wanted) for s in read_sheets(data, wanted, suffix, sheet)]
    cells = [cell.strip() for sheet in sheets for row in sheet.rows for cell in row.fields]
    order = wording.dates.get(path, wording.dates.get("*", "")) or date_order(cells)
    told = wording.decimals.get(path, wording.decimals.get("*", ""))
    return [
        row
        for sheet in sheets
        for row in _rows(
            sheet,
            Reading(
                _columns_of(sheet, wanted, wording, kind.table),
                kind.reason_code,
                wording.words,
                order,
                told or _decimal_mark(cells),
                kind.table,
                sheet.name,
                bool(told),
            ),
        )
    ]


def read_lists(
    root: Path,
    kind: ListKind,
    wording: Wording,
    read_row: Callable[[ListRow, int], Row],
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Read the lists of a kind: rows of its table, and a fault for each that cannot be read.

    Args:
        root: folder of the archive.
        kind: which lists; its table has `path` and `line` too.
        wording: how the lists are worded.
        read_row: from a row and the year in the file's name to the other values.
    """
    good: list[Row] = []
    faults: list[Fault] = []
    for file in list_files(root, kind, wording.files):
        try:
            rows = read_list(root, kind, file.path, wording)
        except DefectiveInputError as error:
            faults.append(fault_from(error, file.path))
            continue
        for row in rows:
            try:
                row.check_whole()
                values = read_row(row, file.season)
            except DefectiveInputError as error:
                faults.append(fault_from(error, file.path))
            else:
                good.append({**values, "path": file.path, "line": row.line})
    frame = frame_of(kind.table, good)
    for misfit, why in misfits(kind.table, frame):
        place, said = (misfit["path"], None, misfit["line"]), at_line(misfit["line"], why)
        faults.append(Fault(*place, kind.reason_code, said))
    return kind.table.filter(frame).result, tuple(faults)


def _columns_of(
    sheet: Sheet, wanted: Sequence[Column], wording: Wording, table: type[dy.Schema]
) -> dict[str, FoundColumn]:
    """Return the columns of a list; one that nobody knows is a fault."""
    optional = [replace(column, required=False) for column in wanted]
    places = find_columns(sheet.header, optional, sheet.line)
    strange = [h for h in unknown_headers(sheet.header, places) if fold(h) not in wording.ignore]
    free = [column for column in wanted if column.key not in places]
    _check_named(sheet, {column.index for column in places.values()})
    if strange:
        raise DefectiveInputError(
            "unknown_column", _strange(_meanings(strange, free, sheet, table)), sheet.line
        )
    columns = find_columns(sheet.header, wanted, sheet.line)
    if not sheet.crews:
        return columns
    of_crews = {key: replace(columns[key], header=sheet.crews) for key in CREW if key in columns}
    return columns | of_crews


def _check_named(sheet: Sheet, known: Collection[int]) -> None:
    """Raise where a column without a name holds something: its header may have been lost."""
    for place, header in enumerate(sheet.header):
        if place in known or fold(header):
            continue
        cells = (row.fields[place].strip() for row in sheet.rows if place < len(row.fields))
        content = next((cell for cell in cells if cell and fold_word(cell) not in NOTHING), None)
        if content is not None:
            said = say(
                "Column {number} has no name and holds '{cell}'. Give it its name; one that is not "
                "needed can be put under ignore in archief.toml.",
                number=place + 1,
                cell=shorten(content),
            )
            raise DefectiveInputError("unknown_column", said, sheet.line)


def _meanings(
    headers: Sequence[str], free: Sequence[Column], sheet: Sheet, table: type[dy.Schema]
) -> tuple[Meaning, ...]:
    """Return what headers that nobody knows can mean, by their names and by their cells."""
    places = {cell.strip(): place for place, cell in enumerate(sheet.header)}
    cells = {
        header: [
            cell
            for row in sheet.rows
            if places[header] < len(row.fields)
            and fold_word(cell := row.fields[places[header]].strip()) not in NOTHING
        ]
        for header in headers
    }
    return meanings(cells, free, partial(_can_stand, table))


def _can_stand(table: type[dy.Schema], column: Column, cell: str) -> bool:
    """Return whether a cell can stand in a column, whatever its limits in another unit."""
    if column.key in _LOOKS:
        return _LOOKS[column.key](cell)
    schema = table.columns().get(column.key)
    if isinstance(schema, dy.Date):
        return is_like_a_date(cell)
    if isinstance(schema, dy.Bool):
        return fold_word(cell) in YES | NO
    if isinstance(schema, dy.Float64 | dy.Int8 | dy.Int16 | dy.Int32 | dy.Int64):
        return _can_be_number(table, column, cell)
    return True


def is_like_a_date(cell: str) -> bool:
    """Return whether there is a date in a cell, in whatever order."""
    return _LIKE_A_DATE.search(cell) is not None or _SERIAL_DATE.fullmatch(cell) is not None


def is_number(cell: str) -> bool:
    """Return whether a cell is a number without a unit, or a time of day."""
    match = _LIKE_A_NUMBER.fullmatch(ungrouped(cell))
    return match is not None and not match[2]


def _can_be_number(table: type[dy.Schema], column: Column, cell: str) -> bool:
    """Return whether a cell is a number with a unit of the column, a whole one where it must."""
    match = _LIKE_A_NUMBER.fullmatch(ungrouped(cell))
    if match is None or not (not match[2] or _is_own_unit(column.key, column.dimension, match[2])):
        return False
    if isinstance(table.columns()[column.key], dy.Float64):
        return True
    lowest, highest = limits(table, column.key)
    return match[1].isdigit() and lowest <= int(match[1][:9]) <= highest


def _is_own_unit(key: str, dimension: str, text: str) -> bool:
    """Return whether a text behind a number is a unit, or says what is counted: `8 roeiers`."""
    names = HEADERS.get(key, ()) if dimension == "none" else ()
    return find_scale(dimension, text) is not None or fold(text) in map(fold, names)


def _can_be_file(cell: str) -> bool:
    """Return whether a cell can be the name of a file: neither a number, nor a date, nor a time."""
    patterns = (_LIKE_A_NUMBER, _LIKE_A_DATE, _LIKE_A_TIME)
    return len(cell) > 3 and not any(pattern.fullmatch(cell) for pattern in patterns)


_LIKE_A_DATE: Final = re.compile(r"[0-9]{1,4}[-/. ]+([0-9]{1,2}|[^\W\d]{3,9})[-/. ]+[0-9]{2,4}")
_LIKE_A_NUMBER: Final = re.compile(r"([+-]?[0-9]+(?:[.,][0-9]+)?)\s*([^0-9\s_].*)?")
_LIKE_A_TIME: Final = re.compile(r"[0-9]{1,2}\s*[:.uhUH]\s*[0-9]{2}.*")
_LIKE_RUNS: Final = re.compile(
    r"b?[0-9]{1,2}(\s*([,;+&\s.-]|en|and|und|et|t/m|tm|bis|to|à)\s*b?[0-9]{1,2}){2,}"
    r"|[0-9]{1,2}\s*(-|t/m|tm|bis|to|à)\s*[0-9]{1,2}"
)
_LOOKS: Final[Mapping[str, Callable[[str], bool]]] = {
    "crew_class": lambda cell: fold_word(cell) in {*CLASSES, *"mvwf"},
    "run": lambda cell: cell.isdigit() and len(cell) <= 2,
    "tow_id": lambda cell: _LIKE_A_DATE.fullmatch(cell) is None,
    "fsn_no": lambda cell: _BOAT.fullmatch(cell) is not None,
    "use_runs": lambda cell: (
        fold_word(cell) in ALL_RUNS or _LIKE_RUNS.fullmatch(fold_word(cell)) is not None
    ),
    "rowing_time_s": lambda cell: _LIKE_A_TIME.fullmatch(cell) is not None,
    "file": _can_be_file,
    "second_file": _can_be_file,
    "name": lambda cell: any(map(str.isalpha, cell)),
    "boat_type": lambda cell: any(map(str.isalpha, cell)),
}
"""What cells of text look like, of columns that not every text can stand in."""


def _strange(unknown: Sequence[Meaning]) -> str:
    """Return the sentence about columns that nobody knows, with the likely known ones."""
    return say(
        "Column {names} is not known. Correct it, name it under [headers] in archief.toml, or put "
        "it there under ignore.",
        names=", ".join(
            f"'{shorten(meaning.header)}'"
            + (f" ({meaning.column.named}?)" if meaning.column else "")
            for meaning in unknown
        ),
        meant=tuple((m.header, m.column.header if m.column else "", m.is_sure) for m in unknown),
    )


def _decimal_mark(cells: Iterable[str]) -> str:
    """Return the marks that stand before decimals, of numbers that can only be read so."""
    return "".join(sorted({m[1] for cell in cells if (m := _DECIMAL.fullmatch(cell))}))


def _rows(sheet: Sheet, reading: Reading) -> list[ListRow]:
    return [
        ListRow(row.line, _cells(row.fields, reading), reading, row.problem) for row in sheet.rows
    ]


def _cells(fields: Sequence[str], reading: Reading) -> dict[str, str]:
    cells = {
        key: _meant(fields[column.index].strip(), reading.words)
        for key, column in reading.columns.items()
        if column.index < len(fields)
    }
    if "tow_id" in cells:  # 2014/17 would be a folder in names of pages and files
        cells["tow_id"] = cells["tow_id"].replace("/", "-")
    return cells


def _meant(cell: str, words: Mapping[str, str]) -> str:
    """Return what a cell stands for: the archive's own words first, then nothing for `n.v.t.`."""
    folded = fold_word(cell)
    if folded in words:
        return words[folded]
    return "" if folded in NOTHING else unicodedata.normalize("NFC", cell)
