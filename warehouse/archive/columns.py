"""The columns that are looked for, and where they are in a header.

A header cell is a name, in any case and with any accents, and its unit in brackets. Nothing is
guessed: other names are given in `archief.toml`.
"""

import csv
import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import say

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


UNITS: Final[Mapping[str, Mapping[str, Scale]]] = {
    "speed": {
        "m/s": Scale(), "cm/s": Scale(1, 100), "km/h": Scale(1, 3.6), "km/u": Scale(1, 3.6),
        "kn": Scale(1852, 3600), "mph": Scale(0.44704), "ft/s": Scale(0.3048),
    },
    "force": {
        "n": Scale(), "kn": Scale(1000), "kgf": Scale(9.80665), "kg": Scale(9.80665),
        "lbf": Scale(4.4482216152605),
    },
    "angle": {
        "gra": Scale(), "deg": Scale(), "graden": Scale(), "°": Scale(),
        "rad": Scale(180, 3.141592653589793),
    },
    "length": {
        "m": Scale(), "cm": Scale(1, 100), "mm": Scale(1, 1000), "km": Scale(1000),
        "nmi": Scale(1852), "ft": Scale(0.3048),
    },
    "mass": {"kg": Scale(), "g": Scale(1, 1000), "lb": Scale(0.45359237)},
    "temperature": {"c": Scale(), "°c": Scale()},
    "ratio": {"%": Scale(1, 100)},
    "rate": {"hz": Scale()},
    "power": {"w": Scale()},
    "time": {"s": Scale(), "ms": Scale(1, 1000)},
    "none": {},
}  # fmt: skip
"""Per dimension the units that people write, in lower case; the SI unit comes first."""


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
    """

    key: str
    header: str
    dimension: str = "none"
    unit: str = ""
    required: bool = True
    also: tuple[str, ...] = ()
    reversed: bool = False

    @property
    def named(self) -> str:
        """Name and unit as they are in a header."""
        return f"{self.header} [{self.unit}]" if self.unit else self.header

    def scale(self, unit: str | None) -> Scale | None:
        """The scale of a unit as written; None where this column cannot have it."""
        scale = UNITS[self.dimension].get((self.unit if unit is None else unit).casefold())
        if scale is None and not self.unit and unit is None:
            return Scale()
        return Scale(-scale.times, scale.divided_by) if scale and self.reversed else scale


@dataclass(frozen=True)
class FoundColumn:
    """Where a column is in a file, its header and unit as written, and what brings it to SI."""

    index: int
    header: str
    scale: Scale
    unit: str = ""

    def to_si(self, number: pl.Expr) -> pl.Expr:
        """A number of this column in its SI unit."""
        return (
            number if self.scale == Scale() else number * self.scale.times / self.scale.divided_by
        )


@lru_cache(100_000)
def fold(text: str) -> str:
    """A header for comparing: its letters and digits, without case and accents."""
    plain = unicodedata.normalize("NFKD", text).casefold()
    return "".join(letter for letter in plain if letter.isalnum())


@lru_cache(100_000)
def fold_word(text: str) -> str:
    """A value or a file name for comparing: without case; blanks inside count once."""
    return " ".join(unicodedata.normalize("NFC", text).casefold().split())


def shorten(text: str) -> str:
    """The text, cut to a length that fits in a sentence."""
    return text[:LONGEST_QUOTE] + ("..." if len(text) > LONGEST_QUOTE else "")


def decode(data: bytes) -> str:
    """The text of a file in UTF-8 or UTF-16 (with its mark), or else Windows-1252.

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
            return unicodedata.normalize("NFC", data.decode(encoding))
        except UnicodeDecodeError:
            continue
    said = say("The file is not text in UTF-8, UTF-16 or Windows-1252: it can be damaged.")
    raise DefectiveInputError("unreadable_file", said)


def split_line(line: str, delimiter: str) -> list[str]:
    """The fields of one line, quotes taken off.

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
    """The folded name in a header cell, and its unit as written where it has one.

    Square brackets hold a unit; round ones only where it is one that anybody knows.
    """
    match = _UNIT.fullmatch(cell.strip())
    if match is None:
        return fold(cell), None
    unit = match[2].strip()
    is_known = any(unit.casefold() in units for units in UNITS.values())
    return (fold(match[1] + match[3]), unit) if is_known or "[" in cell else (fold(cell), None)


def find_header(lines: Sequence[str], columns: Iterable[Column]) -> tuple[int, str]:
    """Which of the first lines is the header, the one that names most columns; its delimiter."""
    wanted = tuple(columns)
    best = 0, 0, ";"
    for place, line in enumerate(lines[:HEADER_WITHIN]):
        delimiter = max(DELIMITERS, key=line.count)
        score = score_of(line.split(delimiter), wanted) if len(line) < 20_000 else 0
        best = max(best, (score, -place, delimiter))
    if best[0] == 0:  # nothing is known in any: what is wrong is told of the first
        filled = next((line for line in lines if line.strip()), "")
        return lines.index(filled) if filled else 0, max(DELIMITERS, key=filled.count)
    return -best[1], best[2]


def score_of(header: Iterable[str], columns: Iterable[Column]) -> int:
    """How many cells of a row are names of columns."""
    names = {fold(name) for column in columns for name in (column.header, *column.also)}
    return len({split_header(cell.strip('"'))[0] for cell in header} & names)


def find_columns(
    header: Sequence[str], columns: Iterable[Column], line: int = 1
) -> dict[str, FoundColumn]:
    """Finds columns by name and unit, in any order.

    Two columns may share a name when their dimensions differ (`wind [m/s]`, `wind [gra]`); one of
    them may leave out its unit.

    Raises:
        DefectiveInputError: `missing_column`, `duplicate_column` or `unknown_unit`.
    """
    by_name: dict[str, list[Column]] = {}
    for column in columns:
        for name in {fold(name) for name in (column.header, *column.also)}:
            by_name.setdefault(name, []).append(column)
    found: dict[str, FoundColumn] = {}
    cells = [(*split_header(cell), index) for index, cell in enumerate(header)]
    for name, unit, index in sorted(cells, key=lambda cell: cell[1] is None):
        namesakes = by_name.get(name, []) if name else []
        if not namesakes:
            continue
        fitting = [c for c in namesakes if c.scale(unit) is not None]
        free = [column for column in fitting if column.key not in found]
        if len(free) != 1:
            raise _not_one(header[index], unit, namesakes, fitting, free, found, line)
        scale = free[0].scale(unit) or Scale()
        told = free[0].unit if unit is None else unit
        found[free[0].key] = FoundColumn(index, header[index].strip(), scale, told)
    wanted = dict.fromkeys(column for named in by_name.values() for column in named)
    missing = [column for column in wanted if column.required and column.key not in found]
    if missing:
        said = say(
            "Not found in the header: {names}. Found: {found}.",
            names=", ".join(f"'{column.named}'" for column in missing),
            found=", ".join(f"'{shorten(cell.strip())}'" for cell in header[:30]),
        )
        raise DefectiveInputError("missing_column", said, line)
    return found


def _not_one(
    cell: str,
    unit: str | None,
    namesakes: Sequence[Column],
    fitting: Sequence[Column],
    free: Sequence[Column],
    found: Mapping[str, FoundColumn],
    line: int,
) -> DefectiveInputError:
    """The error for a header cell that stands for no column, for a taken one, or for several."""
    known = ", ".join(f"[{unit}]" for c in free or namesakes for unit in UNITS[c.dimension])
    if not fitting:
        text = say("Column '{header}' has unit [{unit}]; known here: {known}.")
        said = say(text, header=cell.strip(), unit=unit or "", known=known or "-")
        return DefectiveInputError("unknown_unit", said, line)
    if not free:
        text = say("Columns '{first}' and '{second}' are the same; one of them has to go.")
        said = say(text, first=found[fitting[0].key].header, second=cell.strip())
        return DefectiveInputError("duplicate_column", said, line)
    text = say("Column '{header}' can be more than one thing; write its unit behind it: {known}.")
    said = say(text, header=cell.strip(), known=known)
    return DefectiveInputError("unknown_unit", said, line)


def unknown_headers(header: Sequence[str], found: Mapping[str, FoundColumn]) -> list[str]:
    """The headers of no column that was found; empty ones do not count."""
    taken = {column.index for column in found.values()}
    return [cell.strip() for i, cell in enumerate(header) if i not in taken and fold(cell)]
