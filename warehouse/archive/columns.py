"""The columns that are looked for, and where they are in a header.

A header cell is a name, in any case and with any accents, and its unit in brackets. Nothing is
guessed: other names are given in `archief.toml`.
"""

import csv
import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import Sentence, say

HEADER_WITHIN: Final = 30
"""Lines among which the header is looked for: there may be titles above it."""
DELIMITERS: Final = (";", "\t", ",", "|")
LONGEST_QUOTE: Final = 40
"""Letters of a cell that a sentence quotes."""
_UNIT: Final = re.compile(r"(.*?)[\[(]([^\[\]()]*)[\])](.*)", re.DOTALL)


class Scale(NamedTuple):
    """What brings a number to its SI unit: times the first, divided by the second.

    871 / 100 is exactly 8.71, and 871 * 0.01 need not be.
    """

    times: float = 1.0
    divided_by: float = 1.0


SI: Final = Scale()
CLOCK: Final = Scale(0.0)
"""Stands for a time of day, which is read as text."""
UNITS: Final[Mapping[str, Mapping[str, Scale]]] = {
    "speed": {
        "m/s": SI, "dm/s": Scale(1, 10), "cm/s": Scale(1, 100), "mm/s": Scale(1, 1000),
        "km/h": Scale(1, 3.6), "km/u": Scale(1, 3.6), "kn": Scale(1852, 3600),
        "kt": Scale(1852, 3600), "mph": Scale(0.44704), "ft/s": Scale(0.3048),
    },
    "force": {
        "N": SI, "daN": Scale(10), "hN": Scale(100), "kN": Scale(1000),
        "kgf": Scale(9.80665), "kg": Scale(9.80665), "kp": Scale(9.80665),
        "lbf": Scale(4.4482216152605),
    },
    "angle": {
        "gra": SI, "deg": SI, "graden": SI, "degrees": SI, "°": SI,
        "rad": Scale(180, 3.141592653589793), "gon": Scale(9, 10),
    },
    "length": {
        "m": SI, "dm": Scale(1, 10), "cm": Scale(1, 100), "mm": Scale(1, 1000),
        "km": Scale(1000), "nmi": Scale(1852), "ft": Scale(0.3048),
    },
    "mass": {"kg": SI, "g": Scale(1, 1000), "t": Scale(1000), "lb": Scale(0.45359237)},
    "temperature": {"C": SI, "°C": SI},
    "salinity": {"g/kg": SI, "‰": SI, "ppt": SI, "psu": SI, "%": Scale(10)},
    "ratio": {"%": Scale(1, 100)},
    "rate": {"Hz": SI, "kHz": Scale(1000)},
    "power": {"W": SI, "kW": Scale(1000)},
    "duration": {"s": SI, "ms": Scale(1, 1000), "min": Scale(60)},
    "time": {
        "s": SI, "ms": Scale(1, 1000), "min": Scale(60), "clock": CLOCK, "days": Scale(86400),
        "epoch_ms": Scale(1, 1000),
    },
    "none": {},
}  # fmt: skip
"""Per dimension the units that people write; the SI unit comes first."""


class DefectiveHeaderError(DefectiveInputError):
    """A `DefectiveInputError` that a line of `archief.toml` can settle.

    Attributes:
        ask: the lines, with `?` for the answer.
    """

    def __init__(
        self, reason_code: str, message: str, line: int | None, ask: Sequence[str] = ()
    ) -> None:
        super().__init__(reason_code, message, line)
        self.ask = tuple(ask)


@dataclass(frozen=True)
class Column:
    """A column to look for.

    Attributes:
        key: its name inside the project.
        header: its name in the file, without the unit.
        dimension: key of `UNITS`.
        unit: unit of a header that names none.
        required: a file without it is defective.
        also: other names for it.
        reversed: what is in it has the other sign.
        is_unit_declared: `archief.toml` gives the unit, also where that of the header is unknown.
    """

    key: str
    header: str
    dimension: str = "none"
    unit: str = ""
    required: bool = True
    also: tuple[str, ...] = ()
    reversed: bool = False
    is_unit_declared: bool = False

    @property
    def named(self) -> str:
        """The name and unit as they are in a header."""
        return f"{self.header} [{self.unit}]" if self.unit else self.header

    def scale(self, unit: str | None) -> Scale | None:
        """Return the scale of a unit as written; None where this column cannot have it."""
        if unit is None and not self.unit:
            return Scale()
        scale = find_unit(self.dimension, self.unit if unit is None else unit)
        if scale is None and self.is_unit_declared:
            scale = find_unit(self.dimension, self.unit)
        return Scale(-scale.times, scale.divided_by) if scale and self.reversed else scale


@dataclass(frozen=True)
class FoundColumn:
    """Where a column is in a file, its header and unit as written, and what brings it to SI."""

    index: int
    header: str
    scale: Scale = SI
    unit: str = ""

    def to_si(self, number: pl.Expr) -> pl.Expr:
        """Return a number of this column in its SI unit."""
        return (
            number if self.scale == Scale() else number * self.scale.times / self.scale.divided_by
        )


@lru_cache(10_000)
def find_unit(dimension: str, unit: str) -> Scale | None:
    """Return the scale of a unit, written in any case and with any blanks; None if unknown."""
    wanted = "".join(unit.casefold().split())
    scales = UNITS[dimension]
    return next((scales[known] for known in scales if known.casefold() == wanted), None)


@lru_cache(100_000)
def fold(text: str) -> str:
    """Return a header for comparing: its letters and digits, without case and accents."""
    plain = unicodedata.normalize("NFKD", text).casefold()
    return "".join(filter(str.isalnum, plain))


@lru_cache(100_000)
def fold_word(text: str) -> str:
    """Return a value or a file name for comparing: without case; blanks inside count once."""
    return " ".join(unicodedata.normalize("NFC", text).casefold().split())


def shorten(text: str) -> str:
    """Return the text, cut to a length that fits in a sentence."""
    return text[:LONGEST_QUOTE] + ("..." if len(text) > LONGEST_QUOTE else "")


def quote_names(names: Iterable[str]) -> str:
    """Return names in quotation marks with commas between them, each cut as by `shorten`."""
    return ", ".join(f"'{shorten(name.strip())}'" for name in names)


def decode(data: bytes) -> str:
    """Return the text of a file; see `decode_text`."""
    text, _ = decode_text(data)
    return text


def decode_text(data: bytes) -> tuple[str, str]:
    """Return the text of a file, and its encoding: UTF-8, UTF-16 (with its mark) or Windows-1252.

    Raises:
        DefectiveInputError: `unreadable_file` for anything else, and for an empty file.
    """
    if not data.strip():
        raise DefectiveInputError("unreadable_file", say("The file is empty."))
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        encodings: tuple[str, ...] = ("utf-16",)
    else:  # no text has a zero byte
        encodings = () if 0 in data else ("utf-8-sig", "cp1252")
    for encoding in encodings:
        try:
            return unicodedata.normalize("NFC", data.decode(encoding)), encoding
        except UnicodeDecodeError:
            continue
    said = say("The file is not text in UTF-8, UTF-16 or Windows-1252: it can be damaged.")
    raise DefectiveInputError("unreadable_file", said)


def split_lines(text: str) -> list[str]:
    """Return the lines of a text; behind an end of line at its end comes an empty one."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def split_line(line: str, delimiter: str) -> list[str]:
    """Return the fields of one line, quotes taken off.

    Raises:
        DefectiveInputError: a quotation mark is not closed, or in mid-field.
    """
    if '"' not in line:
        return line.split(delimiter)
    try:
        return next(csv.reader([line], delimiter=delimiter, strict=True), [])
    except csv.Error as error:
        said = say("a quotation mark is not closed, or in mid-field.")
        raise DefectiveInputError("unreadable_file", said) from error


def split_header(cell: str) -> tuple[str, str | None]:
    """Return the folded name in a header cell, and its unit as written where it has one.

    Square brackets hold a unit; round ones only where it is one that anybody knows.
    """
    match = _UNIT.fullmatch(cell.strip())
    if match is None:
        return fold(cell), None
    unit = match[2].strip()
    is_known = any(find_unit(dimension, unit) is not None for dimension in UNITS)
    return (fold(match[1] + match[3]), unit) if is_known or "[" in cell else (fold(cell), None)


def find_header(lines: Sequence[str], columns: Iterable[Column]) -> tuple[int, str]:
    """Find the header, the line that names most columns, and its delimiter."""
    wanted = tuple(columns)
    best = 0, 0, ";"
    for place, line in enumerate(lines[:HEADER_WITHIN]):
        delimiter = max(DELIMITERS, key=line.count)
        score = count_names(line.split(delimiter), wanted) if len(line) < 20_000 else 0
        best = max(best, (score, -place, delimiter))
    if best[0] == 0:  # nothing is known in any: what is wrong is told of the first
        filled = next((line for line in lines if line.strip()), "")
        return lines.index(filled) if filled else 0, max(DELIMITERS, key=filled.count)
    return -best[1], best[2]


def fold_names(columns: Iterable[Column]) -> set[str]:
    """Return all names that columns go by, folded."""
    names = set()
    for column in columns:
        names.add(fold(column.header))
        names.update(map(fold, column.also))
    return names


def count_names(header: Iterable[str], columns: Iterable[Column]) -> int:
    """Return how many cells of a row are names of columns."""
    names = fold_names(columns)
    return len({split_header(cell.strip('"'))[0] for cell in header} & names)


Ask = Callable[..., str]
"""Makes the line of `archief.toml` that answers a question, with a blank for the answer."""


def find_columns(
    header: Sequence[str],
    columns: Sequence[Column],
    line: int = 1,
    ask: Ask | None = None,
    also_ask: Sequence[str] = (),
) -> dict[str, FoundColumn]:
    """Find columns by name and unit, in any order.

    Two columns may share a name when their dimensions differ (`wind [m/s]`, `wind [gra]`); one of
    them may leave out its unit.

    Args:
        header: the cells of the header.
        columns: the columns to look for.
        line: the header's line.
        ask: makes the line of `archief.toml` that would answer what a column or unit is.
        also_ask: lines to show beside these.

    Raises:
        DefectiveHeaderError: `missing_column`, `duplicate_column` or `unknown_unit`; all that is
            wrong is told at once.
    """
    by_name: dict[str, list[Column]] = {}
    for column in columns:
        for name in fold_names([column]):
            by_name.setdefault(name, []).append(column)
    cells = []
    for index, cell in enumerate(header):
        name, unit = split_header(cell)
        if name and name in by_name:
            cells.append((index, unit, by_name[name]))
    # First what can be one column only: of two names for `wind` the other one remains.
    cells.sort(key=lambda cell: (cell[1] is None, len(cell[2])))
    found: dict[str, FoundColumn] = {}
    problems: list[_Problem] = []
    unsettled: set[str] = set()
    for index, unit, namesakes in cells:
        fitting = [column for column in namesakes if column.scale(unit) is not None]
        free = [column for column in fitting if column.key not in found]
        if len(free) == 1:
            scale = free[0].scale(unit) or Scale()
            told = free[0].unit if unit is None else unit
            found[free[0].key] = FoundColumn(index, header[index].strip(), scale, told)
        else:
            problem = _explain_column(header[index], unit, namesakes, fitting, free, found)
            problems.append(problem)
            unsettled.update(column.key for column in namesakes)
    settled = found.keys() | unsettled
    missing = [column for column in columns if column.required and column.key not in settled]
    if missing:
        said = say(
            "Not found in the header: {names}. Found: {found}.",
            names=quote_names(column.named for column in missing),
            found=quote_names(header[:30]),
        )
        problems.append(_Problem("missing_column", said, [f"columns.{c.key}" for c in missing]))
    if not problems:
        return found
    said = problems[0].said
    keys = list(problems[0].keys)
    for problem in problems[1:]:
        said = say("{} {}", said, problem.said)
        keys += problem.keys
    lines = list(map(ask, dict.fromkeys(keys))) if ask else []
    raise DefectiveHeaderError(problems[0].reason_code, said, line, lines + list(also_ask))


class _Problem(NamedTuple):
    """What is wrong with a header: its sentence, and the keys of a profile that would settle it."""

    reason_code: str
    said: Sentence
    keys: Sequence[str]


def _explain_column(
    cell: str,
    unit: str | None,
    namesakes: Sequence[Column],
    fitting: Sequence[Column],
    free: Sequence[Column],
    found: Mapping[str, FoundColumn],
) -> _Problem:
    """Return the fault of a cell that stands for no column, a taken one, or several."""
    units: list[str] = []
    for column in free or namesakes:
        units += UNITS[column.dimension]
    known = ", ".join(f"[{one}]" for one in units)
    if not fitting:
        text = say("Column '{header}' has unit [{unit}]; known here: {known}.")
        said = say(text, header=shorten(cell.strip()), unit=shorten(unit or ""), known=known or "-")
        return _Problem("unknown_unit", said, [f"units.{column.key}" for column in namesakes])
    if not free:
        text = say("Columns '{first}' and '{second}' are the same; one of them has to go.")
        said = say(text, first=found[fitting[0].key].header, second=shorten(cell.strip()))
        return _Problem("duplicate_column", said, [])
    text = say("Column '{header}' can be more than one thing; write its unit behind it: {known}.")
    said = say(text, header=shorten(cell.strip()), known=known)
    return _Problem("unknown_unit", said, [f"columns.{column.key}" for column in free])


def list_unknown_headers(header: Sequence[str], found: Mapping[str, FoundColumn]) -> list[str]:
    """Return the headers of no column that was found; empty ones do not count."""
    taken = {column.index for column in found.values()}
    return [cell.strip() for i, cell in enumerate(header) if i not in taken and fold(cell)]
