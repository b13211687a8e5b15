"""How the federation's text is spelled: bytes, delimiters, headers, units and numbers.

Nothing here knows which file or column it is about, and nothing is guessed from the size of a
number: a unit is in the header or is the declared default.
"""

import codecs
import csv
import difflib
import io
import math
import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Final

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.limits import check_header
from herijk.warehouse.archive.units import (
    BEAUFORT,
    UNITS,
    Scale,
    find_scale,
    fold_unit,
    is_any_unit,
    is_unit,
)
from herijk.words import say

DELIMITERS: Final = (";", "\t", ",", "|")
HEADER_WITHIN: Final = 60
"""Lines among which the header is looked for: there may be titles above it."""

LONGEST_QUOTE: Final = 40
"""Letters of a cell that a sentence quotes."""

NUMBER_PATTERN: Final = r"^[+-]?([0-9]+([.,][0-9]*)?|[.,][0-9]+)([eE][+-]?[0-9]+)?$"
"""An ordinary number with a decimal comma or point. No digit groups, no other scripts' digits."""

_NUMBER: Final = re.compile(NUMBER_PATTERN)
_BRACKETS: Final = re.compile(r"\[([^\[\]]*)\]|\(([^()]*)\)")
_UNIT_BEHIND: Final = re.compile(r"^(.*?[^\s_,])(?:\s*,\s+|\s+in\s+|[\s_]+)(m_s|[^\s_]+)$")
_NO_UNIT_BEHIND: Final = frozenset("cfgksw")
"""Single letters that mean something else behind a name: `log C`, `meetfile s`."""


@dataclass(frozen=True)
class Column:
    """A column to look for.

    Attributes:
        key: its name inside the project.
        header: its name in the file, without the unit.
        dimension: key of `units.UNITS`.
        unit: unit of a header that names none; empty for dimension `none`.
        required: whether a file without it is defective.
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

    def answers_to(self, name: str) -> bool:
        """Whether a folded name is this column's."""
        return name == fold(self.header) or name in _folded(self.also)


@dataclass(frozen=True)
class FoundColumn:
    """Where a column is in a file: its index, the header as written, and the unit's scale."""

    index: int
    header: str
    scale: Scale
    dimension: str = "none"


def decode(data: bytes) -> str:
    """Return the text of a file in UTF-8 or UTF-16 (with or without BOM) or Windows-1252.

    Raises:
        DefectiveInputError: `unreadable_file` for anything else, and for an empty file.
    """
    if not data.strip():
        raise DefectiveInputError("unreadable_file", say("The file is empty."))
    encodings = _encodings(data)
    for encoding in encodings:
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            continue
    raise DefectiveInputError(
        "unreadable_file",
        say("The file is not text in UTF-8, UTF-16 or Windows-1252: it can be damaged."),
    )


def _encodings(data: bytes) -> tuple[str, ...]:
    """Return what the bytes can be: text of Latin letters in UTF-16 has a zero in every other."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return ("utf-16",)
    start = data[:2000]
    zeros = [start[place::2].count(0) for place in (0, 1)]
    if not any(zeros):
        return ("utf-8-sig", "cp1252") if 0 not in data else ()
    if len(start) < 20 or max(zeros) < len(start) // 4 or min(zeros) > 0:
        return ()
    return ("utf-16-be",) if zeros[0] else ("utf-16-le",)


def is_separator_line(line: str) -> bool:
    """Whether a line only tells Excel the separator: `sep=;`."""
    return line.strip().strip('"').casefold().startswith("sep=") and len(line.strip()) <= 7


def find_delimiter(header_line: str) -> str:
    """Return the delimiter that occurs most in a header; a blank, then `;`, when there is none.

    Raises:
        DefectiveInputError: `too_large`: it is longer than a header can be.
    """
    most = max(DELIMITERS, key=header_line.count)
    check_header(header_line, header_line.count(most) + 1)
    if most not in header_line and len(header_line.split()) > 1:
        return " "
    return most


def split_line(line: str, delimiter: str) -> list[str]:
    """Return the fields of one line, quotes taken off.

    Raises:
        DefectiveInputError: `unreadable_file`, e.g. when a quotation mark is not closed.
    """
    if delimiter == " ":
        return line.split()
    try:
        return next(csv.reader(io.StringIO(line), delimiter=delimiter, strict=True), [])
    except csv.Error as error:
        said = say("The header is no row of a table: {error}.", error=error)
        raise DefectiveInputError("unreadable_file", said, line=1) from error


@lru_cache(10_000)
def fold(text: str) -> str:
    """Return a header for comparing: its letters and digits, without case and accents."""
    plain = unicodedata.normalize("NFKD", text).casefold()
    return "".join(letter for letter in plain if letter.isalnum())


@cache
def _folded(names: tuple[str, ...]) -> frozenset[str]:
    return frozenset(fold(name) for name in names)


def fold_word(text: str) -> str:
    """Return a value or a file name for comparing: without case; blanks inside count once."""
    return " ".join(unicodedata.normalize("NFC", text).casefold().split())


def split_header(cell: str) -> tuple[str, str | None]:
    """Return the folded name in a header cell, and its unit as written where it has one.

    A unit is in brackets, or last (`kracht, N`, `snelheid in kn`, `breedte_cm`); other brackets
    belong to the name.
    """
    cell = cell.strip()
    groups = list(_BRACKETS.finditer(cell))
    units = [group for group in groups if is_any_unit(_last_part(group)[1])]
    square = [group for group in groups if group[1] is not None]
    for group in units or square[-1:]:
        more, unit = _last_part(group)
        return fold(cell[: group.start()] + more + cell[group.end() :]), unit
    behind = _UNIT_BEHIND.match(cell)
    unit = behind[2].replace("m_s", "m/s") if behind else ""
    if behind and is_unit(unit) and unit.casefold() not in _NO_UNIT_BEHIND:
        return fold(behind[1]), unit
    return fold(cell), None


def _last_part(group: re.Match[str]) -> tuple[str, str]:
    """Return what is in brackets before the last comma, and behind it: `(richting, graden)`."""
    more, _, unit = (group[1] or group[2] or "").rpartition(",")
    return more, unit.strip()


def with_units(header: Sequence[str], below: Sequence[str]) -> list[str] | None:
    """Return a header with the units of the row below it; None where that row is no row of units.

    Args:
        header: the cells of the header.
        below: the cells of the next row: `m/s`, `[N]`, or nothing.
    """
    units = [cell.strip().strip("[]()").strip() for cell in below]
    if len(units) > len(header) or not any(units):
        return None
    if not any(map(is_unit, units)):
        return None
    if not all(is_any_unit(unit) for unit in units if fold(unit) or unit in {"%", "°"}):
        return None
    units += [""] * (len(header) - len(units))
    pairs = zip(header, units, strict=True)
    return [f"{name} [{unit}]" if is_any_unit(unit) else name for name, unit in pairs]


def is_rest_of_header(header: Sequence[str], below: Sequence[str]) -> bool:
    """Whether a row goes on with the header above it: not a digit, and units or names it lacks."""
    if any(map(str.isdigit, "".join(below))) or not any(map(str.strip, below)):
        return False
    names = [cell.strip() for cell in header if cell.strip()]
    has_units = any(is_unit(cell.strip("[]() ")) or split_header(cell)[1] for cell in below)
    return has_units or len(set(names)) < len(names)


def find_columns(
    header: Sequence[str], columns: Iterable[Column], line: int = 1
) -> dict[str, FoundColumn]:
    """Find columns by name and unit, in any order.

    Two columns may share a name when their dimensions differ (`wind [m/s]`, `wind [gra]`). A
    column's own name goes before its other names: where it stands they are left alone. A header
    without a unit is the one column of that name that no other header took.

    Args:
        header: the cells of the header.
        columns: the columns to look for.
        line: the header's line in the file.

    Raises:
        DefectiveInputError: `missing_column`, `duplicate_column` or `unknown_unit`.
    """
    wanted = tuple(columns)
    places: dict[str, FoundColumn] = {}
    cells = [split_header(cell) for cell in header]
    own_names = {fold(column.header) for column in wanted}
    own_first = sorted(range(len(cells)), key=lambda i: cells[i][0] not in own_names)
    for is_clear in (True, False):
        for index in own_first:
            name, unit = cells[index]
            namesakes = [column for column in wanted if name and column.answers_to(name)]
            if name not in own_names:
                taken = {c.key for c in namesakes if _is_own(c, places)}
                namesakes = [column for column in namesakes if column.key not in taken]
            if not namesakes or (unit is not None or len(namesakes) == 1) != is_clear:
                continue
            column = _choose(namesakes, unit, header[index], places, line)
            scale = find_scale(column.dimension, unit or column.unit) or Scale()
            scale = scale.turned() if column.reversed else scale
            places[column.key] = FoundColumn(index, header[index].strip(), scale, column.dimension)
    missing = [column for column in wanted if column.required and column.key not in places]
    if missing:
        raise DefectiveInputError("missing_column", _missing_message(missing, header, places), line)
    return places


def _is_own(column: Column, places: Mapping[str, FoundColumn]) -> bool:
    """Whether a column was found by its own name."""
    place = places.get(column.key)
    return place is not None and split_header(place.header)[0] == fold(column.header)


def unknown_headers(header: Sequence[str], places: Mapping[str, FoundColumn]) -> list[str]:
    """Return the headers of no column that was found; empty ones do not count."""
    taken = {column.index for column in places.values()}
    return [cell.strip() for i, cell in enumerate(header) if i not in taken and fold(cell)]


def nearest_column(cell: str, columns: Iterable[Column]) -> Column | None:
    """Return the column whose name is most like a header; None when none is like it."""
    names = {fold(name): column for column in columns for name in (column.header, *column.also)}
    like = difflib.get_close_matches(split_header(cell)[0], names, n=1, cutoff=0.6)
    return names[like[0]] if like else None


def score_of(header: Sequence[str], columns: Iterable[Column]) -> int:
    """Return how many cells of a line are names of columns: the header has most."""
    names = _names_of(tuple(columns))
    return sum(split_header(cell)[0] in names for cell in header)


@cache
def _names_of(columns: tuple[Column, ...]) -> frozenset[str]:
    return frozenset(fold(name) for c in columns for name in (c.header, *c.also))


def _choose(
    namesakes: list[Column], unit: str | None, cell: str, places: dict[str, FoundColumn], line: int
) -> Column:
    """Return the one column a header cell stands for."""
    fitting = [c for c in namesakes if unit is None or find_scale(c.dimension, unit) is not None]
    if unit is not None and fold_unit(unit) in BEAUFORT:
        said = say(
            "Column '{header}' is in Beaufort, which is a range of winds and no speed. Without a "
            "wind in m/s put wind under absent in the season's profile in archief.toml.",
            header=cell.strip(),
            absent=("wind",),
        )
        raise DefectiveInputError("unknown_unit", said, line)
    if not fitting:
        known = sorted({name for column in namesakes for name in UNITS[column.dimension]})
        said = say(
            "Column '{header}' has unit [{unit}]; known here: {known}.",
            header=cell.strip(),
            unit=unit,
            known=_in_brackets(known) or "-",
        )
        raise DefectiveInputError("unknown_unit", said, line)
    free = [column for column in fitting if column.key not in places]
    if not free:
        said = say(
            "Columns '{first}' and '{second}' are the same; one of them has to go.",
            first=places[fitting[0].key].header,
            second=cell.strip(),
        )
        raise DefectiveInputError("duplicate_column", said, line)
    if len(free) > 1:
        said = say(
            "Column '{header}' can be more than one thing; write its unit behind it: {known}.",
            header=cell.strip(),
            known=_in_brackets(column.unit for column in free),
        )
        raise DefectiveInputError("unknown_unit", said, line)
    return free[0]


def _missing_message(
    missing: list[Column], header: Sequence[str], places: Mapping[str, FoundColumn]
) -> str:
    return say(
        "Not found in the header: {names}. Found: {found}.",
        names=", ".join(f"'{column.named}'" for column in missing),
        found=", ".join(f"'{shorten(cell.strip())}'" for cell in header[:30]),
        keys=tuple(column.key for column in missing),
        header=tuple(unknown_headers(header, places)),
    )


def _in_brackets(units: Iterable[str]) -> str:
    return ", ".join(f"[{unit}]" for unit in units)


def parse_number(text: str) -> float:
    """Return the number a cell holds.

    Raises:
        ValueError: the cell is empty, not an ordinary number, or too large to be one.
    """
    stripped = text.strip(" \t")
    if not _NUMBER.match(stripped):
        raise ValueError(f"'{shorten(text)}' is not a number" if stripped else "is empty")
    number = float(stripped.replace(",", "."))
    if not math.isfinite(number):
        raise ValueError(f"'{shorten(text)}' is too large")
    return number


def shorten(text: str) -> str:
    """Return the text, printable and cut to a length that fits in a sentence."""
    printable = "".join(letter if letter.isprintable() else "?" for letter in text[:LONGEST_QUOTE])
    return printable + ("..." if len(text) > LONGEST_QUOTE else "")
