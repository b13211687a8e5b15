"""What the cells of a list say: text, as values of the types that the list's table declares."""

import datetime as dt
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any, Final

import polars as pl

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.messages import Sentence, say
from pipeline.tables.declare import dy
from pipeline.tables.frames import column_of, limits
from warehouse.archive.spelling.columns import Column, FoundColumn
from warehouse.archive.spelling.dates import AmbiguousDateError, parse_date
from warehouse.archive.spelling.numbers import THOUSAND, WITH_UNIT, parse_number, ungrouped
from warehouse.archive.spelling.synonyms import CLASSES, HEADERS, NO, YES
from warehouse.archive.spelling.text import fold, fold_word, shorten
from warehouse.archive.spelling.units import UNITS, Scale, find_scale

BOAT_NUMBER: Final = re.compile(
    r"(?:fsn)?[\s._-]*(?:(?:nr|no|nummer|number|n°|nº)[\s.:_-]*)?([0-9]{1,6}[a-z]?)", re.IGNORECASE
)
_RUN: Final = re.compile(r"(b?)([1-9][0-9]?)", re.IGNORECASE)
_ROWING_TIME: Final = re.compile(
    r"([0-9]{1,2})(?::|\.|[uh]\s*)([0-5]?[0-9])(?::|\.|['m]\s*)([0-5]?[0-9])(?:[.,]0*|[\"s])?"
)


class WrongError(Exception):
    """A cell or a row cannot be right.

    Args:
        text: a sentence, with values in braces.
        code: reason code; None for that of the list.
        values: what is filled in; of a cell `column` and `cell` are known.
    """

    def __init__(self, text: str, code: str | None = None, **values: object) -> None:
        super().__init__(text)
        self.text = text
        self.code = code
        self.values = values

    def in_words(self, column: str = "", cell: str = "") -> Sentence:
        """The sentence; of a cell with its column and what is in it."""
        return say(self.text, **{"column": column, "cell": shorten(cell), **self.values})


@dataclass(frozen=True)
class Reading:
    """How the cells of one list are read.

    Attributes:
        columns: the columns found in the header.
        table: declares the type and the limits of each value.
        date_order: `dmy` or `mdy` where dates with slashes are settled, else empty.
        decimal: the decimal marks that this list surely uses, comma, point, or both.
        is_told: `archief.toml` says which mark that is.
    """

    columns: Mapping[str, FoundColumn]
    table: type[dy.Schema]
    date_order: str
    decimal: str
    is_told: bool

    def named(self, key: str) -> str:
        """What the file calls a column."""
        place = self.columns.get(key)
        return place.header if place else key


Wrong = dict[str | None, tuple[str | None, Sentence]]
"""Reason code and sentence of cells that cannot be read; of empty ones under None."""


def read_column(cells: pl.Series, column: Column, reading: Reading) -> tuple[pl.Series, Wrong]:
    """The values of a column, null where a cell is empty or cannot be read; and what is wrong.

    Every spelling is read once. A cell may be empty if the table or the header can do without it.
    """
    key, named = column.key, reading.named(column.key)
    declared = column_of(reading.table, key) if key in reading.table.column_names() else None
    dtype = pl.String() if declared is None else declared.dtype
    read = _READERS_BY_KEY.get(key) or _READERS.get(dtype.base_type())
    if dtype == pl.Boolean():
        cells = cells.fill_null("nee")
    values: dict[str, Any] = {}
    wrong: Wrong = {}
    if read is not None:
        for cell in cells.drop_nulls().unique(maintain_order=True):
            try:
                values[cell] = read(cell, key, reading)
            except WrongError as error:
                wrong[cell] = error.code, error.in_words(named, cell)
    if column.required and not (declared is not None and declared.nullable):
        wrong[None] = None, say("column '{column}' is empty.", column=named)
    if read is None:
        return cells, wrong
    if not values:
        return pl.Series(cells.name, [None] * len(cells), dtype), wrong
    read_as = cells.replace_strict(values, default=None, return_dtype=dtype)
    return read_as, wrong


def _number(cell: str, key: str, reading: Reading) -> float:
    """A number in SI units within the limits."""
    digits, scale = _digits_and_scale(cell, key, reading)
    value = scale.to_si(parse_number(digits))
    lowest, highest = limits(reading.table, key)
    if THOUSAND.fullmatch(digits):
        thousands = scale.to_si(1000 * parse_number(digits))
        if lowest <= thousands <= highest:
            is_in_ones = lowest <= value <= highest and _is_in_ones(digits, reading)
            value = value if is_in_ones else thousands
    if not lowest <= value <= highest:
        low, high = (scale.from_si(limit) for limit in (lowest, highest))
        text = say("column '{column}' is {cell}; {low:g} to {high:g} can be right.")
        raise WrongError(text, low=low, high=high)
    return value


def _digits_and_scale(cell: str, key: str, reading: Reading) -> tuple[str, Scale]:
    """The number in a cell and its scale: its own unit goes before the header's."""
    column = reading.columns[key]
    own = WITH_UNIT.fullmatch(cell)
    if own and not UNITS[column.dimension] and is_own_unit(key, column.dimension, own[2]):
        cell, own = own[1], None
    scale = find_scale(column.dimension, own[2]) if own and UNITS[column.dimension] else None
    try:
        digits = ungrouped(own[1] if own and scale else cell)
        parse_number(digits)
    except ValueError as error:
        text = say("column '{column}' is '{cell}', which is not an ordinary number.")
        raise WrongError(text) from error
    return digits, scale or column.scale


def is_own_unit(key: str, dimension: str, text: str) -> bool:
    """Whether a text behind a number is a unit, or says what is counted: `8 roeiers`."""
    names = HEADERS.get(key, ()) if dimension == "none" else ()
    return find_scale(dimension, text) is not None or fold(text) in map(fold, names)


def _is_in_ones(digits: str, reading: Reading) -> bool:
    """Whether 1.140 is little more than one, where it and 1140 can be right.

    Raises where this list writes its decimals with the other mark.
    """
    mark = "," if "," in digits else "."
    if reading.decimal in {"", mark}:
        return True
    if reading.is_told:
        return False
    other = reading.decimal.replace(mark, "")
    text = say(
        "column '{column}' is {cell}, while other numbers of this list have their decimals "
        "behind a '{mark}'; write {whole} or {decimal}."
    )
    whole, decimal = digits.replace(mark, ""), digits.replace(mark, other)
    raise WrongError(
        text, "ambiguous_number", cell=digits, mark=other, whole=whole, decimal=decimal
    )


def _integer(cell: str, key: str, reading: Reading) -> int:
    value = _number(cell, key, reading)
    if value != int(value):
        raise WrongError(say("column '{column}' is {cell}; it must be a whole number."))
    return int(value)


def _date(cell: str, _: str, reading: Reading) -> dt.date:
    try:
        return parse_date(cell, reading.date_order)
    except AmbiguousDateError as error:
        text = say("column '{column}' is '{cell}': is the first number the day or the month?")
        raise WrongError(text, "ambiguous_date") from error
    except ValueError as error:
        text = say("column '{column}' is '{cell}', not a date such as 2014-03-01 or 01-03-2014.")
        raise WrongError(text) from error


def _run(cell: str, key: str, _: Reading) -> int:
    """The number of a run: 1 to 20, or 21 to 40 for b1 to b20."""
    return run_number(cell, key, range(1, MOST_RUNS + 1))


def run_number(part: str, column: str, planned: Collection[int]) -> int:
    """The number of a run as written in a list: 1 and on, or 21 and on for b1 and on.

    Raises:
        WrongError: it is not one.
    """
    match = _RUN.fullmatch(part)
    if match is None or int(match[2]) not in planned:
        text = say(
            "column '{column}' has '{part}'; runs are 1 to {last}, or b1 to b{last} for the "
            "second file, with commas between them. Runs beyond these need a [[plan]]."
        )
        raise WrongError(text, column=column, part=shorten(part), last=max(planned))
    return int(match[2]) + (SECOND_FILE_OFFSET if match[1] else 0)


def _crew_class(cell: str, _: str, __: Reading) -> str:
    value = CLASSES.get(fold_word(cell))
    if value is None:
        raise WrongError(say("column '{column}' is '{cell}'; H or D is expected."), choices="H, D")
    return value


def _yes_or_no(cell: str, _: str, __: Reading) -> bool:
    word = fold_word(cell)
    if word in YES or word in NO:
        return word in YES
    raise WrongError(say("column '{column}' is '{cell}', not ja, nee or empty."), choices="ja, nee")


def _boat(cell: str, _: str, __: Reading) -> str:
    """The number of a boat: `FSN 101`, `fsn nr 101` and `101` are FSN101."""
    number = BOAT_NUMBER.fullmatch(cell.strip())
    return f"FSN{number[1].upper()}" if number else cell


def _rowing_time(cell: str, _: str, __: Reading) -> float:
    match = _ROWING_TIME.fullmatch(cell)
    if match is None:
        raise WrongError(say("'roeitijd' is '{cell}', not a time such as 2:10:25."))
    seconds = int(match[1]) * 3600 + int(match[2]) * 60 + int(match[3])
    if seconds == 0:
        raise WrongError(say("'roeitijd' is 0."))
    return float(seconds)


_Reader = Callable[[str, str, Reading], object]
_READERS_BY_KEY: Final[Mapping[str, _Reader]] = {
    "fsn_no": _boat,
    "crew_class": _crew_class,
    "run": _run,
    "rowing_time_s": _rowing_time,
}
_READERS: Final[Mapping[type[pl.DataType], _Reader]] = {
    pl.Float64: _number,
    **dict.fromkeys((pl.Int8, pl.Int16, pl.Int32), _integer),
    pl.Date: _date,
    pl.Boolean: _yes_or_no,
}
