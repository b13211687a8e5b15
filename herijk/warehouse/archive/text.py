"""How the federation's text is spelled: bytes, delimiters, headers, units and numbers.

Nothing here knows which file or column it is about, and nothing is guessed from the size of a
number: a unit stands in the header or is the declared default.
"""

import csv
import io
import math
import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.limits import check_header

DELIMITERS: Final = (";", "\t", ",")

UNITS: Final[dict[str, dict[str, tuple[float, float]]]] = {
    "none": {},
    "speed": {"m/s": (1, 1), "km/h": (1, 3.6), "kn": (1852, 3600)},
    "force": {"n": (1, 1), "kgf": (9.80665, 1)},
    "angle": {"gra": (1, 1), "deg": (1, 1), "rad": (180, math.pi)},
    "length": {"m": (1, 1), "cm": (1, 100), "km": (1000, 1)},
    "mass": {"kg": (1, 1)},
    "temperature": {"c": (1, 1)},
    "ratio": {"%": (1, 100)},
    "rate": {"hz": (1, 1)},
    "power": {"w": (1, 1)},
    "time": {"s": (1, 1)},
}
"""Per dimension and unit the (numerator, denominator) that brings a number to the SI unit
(degrees for angles). Two numbers, as 871 / 100 is exactly 8.71 and 871 * 0.01 need not be."""

NUMBER_PATTERN: Final = r"^[+-]?([0-9]+([.,][0-9]*)?|[.,][0-9]+)([eE][+-]?[0-9]+)?$"
"""An ordinary number with a decimal comma or point. No digit groups, no other scripts' digits."""

_NUMBER: Final = re.compile(NUMBER_PATTERN)
_HEADER: Final = re.compile(r"^([^\[\]]*)(?:\[([^\[\]]*)\])?$")


@dataclass(frozen=True)
class Column:
    """A column to look for.

    Attributes:
        key: its name inside the project.
        header: its name in the file, without the unit.
        dimension: key of `UNITS`.
        unit: unit of a header without square brackets; empty for dimension `none`.
        required: whether a file without it is defective.
    """

    key: str
    header: str
    dimension: str = "none"
    unit: str = ""
    required: bool = True


@dataclass(frozen=True)
class FoundColumn:
    """Where a column stands in a file: its index, the header as written, and the unit's scale."""

    index: int
    header: str
    scale: tuple[float, float]


def decode(data: bytes) -> str:
    """Return the text of a UTF-8 (with or without BOM) or Windows-1252 file.

    Raises:
        DefectiveInputError: `unreadable_file` for anything else, and for an empty file.
    """
    if not data.strip():
        raise DefectiveInputError("unreadable_file", "The file is empty.")
    if b"\x00" in data:
        raise DefectiveInputError(
            "unreadable_file",
            "The file holds zero bytes, so it is not a text file in UTF-8 or Windows-1252 "
            "(a spreadsheet, UTF-16 or a damaged copy?).",
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        pass
    try:
        return data.decode("cp1252")
    except UnicodeDecodeError as error:
        raise DefectiveInputError(
            "unreadable_file",
            f"Byte {error.start} of the file is neither UTF-8 nor Windows-1252.",
        ) from error


def find_delimiter(header_line: str) -> str:
    """Return the delimiter that occurs most in a header; `;` when there is none.

    Raises:
        DefectiveInputError: `too_large`: it is longer than a header can be.
    """
    delimiter = max(DELIMITERS, key=header_line.count)
    check_header(header_line, header_line.count(delimiter) + 1)
    return delimiter


def split_line(line: str, delimiter: str) -> list[str]:
    """Return the fields of one line, quotes taken off.

    Raises:
        DefectiveInputError: `unreadable_file`, e.g. when a quotation mark is not closed.
    """
    try:
        return next(csv.reader(io.StringIO(line), delimiter=delimiter, strict=True), [])
    except csv.Error as error:
        raise DefectiveInputError(
            "unreadable_file", f"The header is no row of a table: {error}.", line=1
        ) from error


def fold(text: str) -> str:
    """Return a header or unit for comparing: without case, blanks and ways to write an accent."""
    return "".join(unicodedata.normalize("NFC", text).casefold().split())


def fold_name(text: str) -> str:
    """Return a file name for comparing: as `fold`, but blanks inside count, once."""
    return " ".join(unicodedata.normalize("NFC", text).casefold().split())


def scale_of(dimension: str, unit: str) -> tuple[float, float]:
    """Return (numerator, denominator) of a unit; a dimension without units has scale 1."""
    return UNITS[dimension][fold(unit)] if unit else (1, 1)


def find_columns(header: Sequence[str], columns: Iterable[Column]) -> dict[str, FoundColumn]:
    """Find columns by name and unit, in any order; columns nobody asked for are ignored.

    Two columns may share a name when their dimensions differ (`wind [m/s]`, `wind [gra]`).
    A header without a unit is the one column of that name that no header with a unit took.

    Raises:
        DefectiveInputError: `missing_column`, `duplicate_column` or `unknown_unit`.
    """
    wanted = tuple(columns)
    found: dict[str, FoundColumn] = {}
    cells = [_parse_header(cell) for cell in header]
    with_unit_first = sorted(range(len(cells)), key=lambda index: cells[index][1] is None)
    for index in with_unit_first:
        name, unit = cells[index]
        namesakes = [column for column in wanted if fold(column.header) == name]
        if not namesakes:
            continue
        column = _choose(namesakes, unit, header[index], found)
        found[column.key] = FoundColumn(
            index, header[index].strip(), scale_of(column.dimension, unit or column.unit)
        )
    missing = [column for column in wanted if column.required and column.key not in found]
    if missing:
        raise DefectiveInputError("missing_column", _missing_message(missing, header), line=1)
    return found


def _parse_header(cell: str) -> tuple[str, str | None]:
    match = _HEADER.match(cell.strip())
    if match is None:
        return fold(cell), None
    return fold(match[1]), None if match[2] is None else fold(match[2])


def _choose(
    namesakes: list[Column], unit: str | None, cell: str, found: dict[str, FoundColumn]
) -> Column:
    """Return the one column a header cell stands for."""
    fitting = [column for column in namesakes if unit is None or unit in UNITS[column.dimension]]
    if not fitting:
        known = sorted({name for column in namesakes for name in UNITS[column.dimension]})
        raise DefectiveInputError(
            "unknown_unit",
            f"Column '{cell.strip()}' has unit [{unit}]; "
            + (f"known here: {_in_brackets(known)}." if known else "it should have none."),
            line=1,
        )
    free = [column for column in fitting if column.key not in found]
    if not free:
        first = found[fitting[0].key].header
        raise DefectiveInputError(
            "duplicate_column",
            f"Columns '{first}' and '{cell.strip()}' are the same; one of them has to go.",
            line=1,
        )
    if len(free) > 1:
        known = [column.unit for column in free]
        raise DefectiveInputError(
            "unknown_unit",
            f"Column '{cell.strip()}' can be more than one thing; write its unit behind it: "
            f"{_in_brackets(known)}.",
            line=1,
        )
    return free[0]


def _missing_message(missing: list[Column], header: Sequence[str]) -> str:
    names = ", ".join(
        f"'{column.header}{f' [{column.unit}]' if column.unit else ''}'" for column in missing
    )
    seen = ", ".join(f"'{shorten(cell.strip())}'" for cell in header[:30])
    return f"Not found in the header: {names}. Found: {seen}."


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


def shorten(text: str, longest: int = 40) -> str:
    """Return the text, printable and cut to a length that fits in a sentence."""
    printable = "".join(letter if letter.isprintable() else "?" for letter in text[:longest])
    return printable + ("..." if len(text) > longest else "")
