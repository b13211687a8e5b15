"""Columns that are looked for, and where they are in a header.

Which line the header is, is told by the names in it.
"""

import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.spelling.headers import split_header
from warehouse.archive.spelling.text import (
    fold,
    is_separator_line,
    shorten,
    split_or_nothing,
)
from warehouse.archive.spelling.units import UNITS, Scale, find_scale

HEADER_WITHIN: Final = 60
"""Lines among which the header is looked for: there may be titles above it."""
_LETTER: Final = re.compile(r"[^\W\d_]")


@dataclass(frozen=True)
class Column:
    """A column to look for.

    Attributes:
        key: its name inside the project.
        header: its name in the file, without the unit.
        dimension: key of `units.UNITS`.
        unit: unit of a header that names none; empty for dimension `none`.
        unit_given: whether a person gave that unit; then it is also that of a unit nobody knows.
        required: whether a file without it is defective.
        also: other names for it.
        reversed: what is in it has the other sign.
        or_else: key of the column that serves where a list does not have this one.
    """

    key: str
    header: str
    dimension: str = "none"
    unit: str = ""
    unit_given: bool = False
    required: bool = True
    also: tuple[str, ...] = ()
    reversed: bool = False
    or_else: str = ""

    @property
    def named(self) -> str:
        """Name and unit as they are in a header."""
        return f"{self.header} [{self.unit}]" if self.unit else self.header

    def answers_to(self, name: str) -> bool:
        """Whether a folded name is this column's."""
        return name in _folded((self.header, *self.also))


@dataclass(frozen=True)
class FoundColumn:
    """Where a column is in a file: its index, the header as written, and the unit's scale."""

    index: int
    header: str
    scale: Scale
    dimension: str = "none"


@cache
def _folded(names: tuple[str, ...]) -> frozenset[str]:
    return frozenset(split_header(name)[0] for name in names)


def find_columns(
    header: Sequence[str], columns: Iterable[Column], line: int = 1
) -> dict[str, FoundColumn]:
    """Finds columns by name and unit, in any order.

    Two columns may share a name when their dimensions differ (`wind [m/s]`, `wind [gra]`). A
    column's own name goes before its other names: where it occurs they are left alone. A header
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
    cells = [_name_and_unit(cell, wanted) for cell in header]
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
    """The headers of no column that was found; empty ones do not count."""
    taken = {column.index for column in places.values()}
    return [cell.strip() for i, cell in enumerate(header) if i not in taken and fold(cell)]


def nearest_columns(cell: str, columns: Iterable[Column], least_alike: float = 0.6) -> list[Column]:
    """The columns with a name that is like a header, at most three, the nearest first."""
    names = {fold(name): column for column in columns for name in (column.header, *column.also)}
    near = difflib.get_close_matches(split_header(cell)[0], names, n=9, cutoff=least_alike)
    return list(dict.fromkeys(names[name] for name in near))[:3]


def _name_and_unit(cell: str, columns: Iterable[Column]) -> tuple[str, str | None]:
    """Of a header cell; a unit that nobody knows gives way to the one that a person gave."""
    name, unit = split_header(cell)
    of_name = (column for column in columns if column.unit_given and column.answers_to(name))
    gives_way = unit and any(find_scale(column.dimension, unit) is None for column in of_name)
    return name, None if gives_way else unit


def _choose(
    namesakes: list[Column], unit: str | None, cell: str, places: dict[str, FoundColumn], line: int
) -> Column:
    """The one column a header cell stands for."""
    fitting = [c for c in namesakes if unit is None or find_scale(c.dimension, unit) is not None]
    if not fitting:
        known = sorted({name for column in namesakes for name in UNITS[column.dimension]})
        said = say(
            "Column '{header}' has unit [{unit}]; known here: {known}.",
            header=cell.strip(),
            unit=unit,
            known=_in_brackets(known) or "-",
            keys=tuple(column.key for column in namesakes),
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
            can_be=tuple(column.key for column in free),
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


def score_of(header: Sequence[str], columns: Iterable[Column]) -> int:
    """How many cells of a line are names of columns: the header has most."""
    names = frozenset[str]().union(*(_folded((c.header, *c.also)) for c in columns))
    return sum(split_header(cell)[0] in names for cell in header)


def find_header(lines: Sequence[str], columns: Sequence[Column]) -> int:
    """Which of the first lines is the header."""
    rows = [
        split_or_nothing(line) if _LETTER.search(line) and not is_separator_line(line) else []
        for line in lines[:HEADER_WITHIN]
    ]
    return header_among(rows, columns)


def header_among(rows: Sequence[Sequence[str]], columns: Sequence[Column]) -> int:
    """Which row names most columns; where none names two, the first with most names."""
    scores = [score_of(row, columns) for row in rows]
    if max(scores, default=0) < 2:
        scores = [score + _texts(row) for score, row in zip(scores, rows, strict=True)]
    return scores.index(max(scores)) if scores else 0


def _texts(row: Sequence[str]) -> int:
    """How many cells of a row are text, 0 where one is a number."""
    cells = [cell.strip() for cell in row if cell.strip()]
    is_data = any(cell[0].isdigit() or cell[0] in "+-" for cell in cells)
    return 0 if is_data else len(cells)
