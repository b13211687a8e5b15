"""What a column that nobody knows can mean: by its name, by its unit, and by what is in it.

A guess for a person to look at: `check` proposes it, and nothing is read by it.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.declare import dy
from warehouse.archive.sheets.cell_contents import FITS, can_stand
from warehouse.archive.sheets.sheet import Sheet
from warehouse.archive.spelling.columns import Column
from warehouse.archive.spelling.headers import split_header
from warehouse.archive.spelling.likeness import likeness
from warehouse.archive.spelling.synonyms import NOTHING
from warehouse.archive.spelling.text import fold, fold_word, shorten
from warehouse.archive.spelling.units import find_scale

_BY_CONTENT: Final = frozenset({"use_runs", "crew_class"})
"""Columns that need not be there, and that are recognised by their content."""
_DISTINCT: Final = frozenset({"tow_id", "file"})

Cells = Mapping[str, Sequence[str]]
"""The cells under each header that nobody knows."""
Fits = Callable[[Column, str], bool]
"""Whether a cell can belong to a column."""


@dataclass(frozen=True)
class Meaning:
    """What a header can mean.

    Attributes:
        header: the header as written.
        column: the column that it can be; None where it is like none.
        is_sure: name and content agree; otherwise only the content says so.
    """

    header: str
    column: Column | None
    is_sure: bool = True


def check_named(sheet: Sheet, known: Collection[int]) -> None:
    """Raises where a column without a name holds something: its header may have been lost."""
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


def meanings_in(
    headers: Sequence[str], free: Sequence[Column], sheet: Sheet, table: type[dy.Schema]
) -> tuple[Meaning, ...]:
    """What headers that nobody knows can mean, by their names and by their cells."""
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
    return meanings(cells, free, partial(can_stand, table))


def about_unknown(unknown: Sequence[Meaning]) -> str:
    """The sentence about columns that nobody knows, with the likely known ones."""
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


def meanings(strange: Cells, free: Sequence[Column], fits: Fits) -> tuple[Meaning, ...]:
    """What each of the headers can mean, every column at most once.

    Args:
        strange: the cells under each header that nobody knows.
        free: the columns that no header has.
        fits: whether a cell can belong to a column.
    """
    meant: dict[str, Meaning] = {}
    needed = [column for column in free if column.required]
    by_content = [column for column in free if column.key in _BY_CONTENT]
    for guess, columns in (
        (_by_name, needed),
        (_by_content, needed),
        (_by_name, free),
        (_by_content, by_content),
        (_by_unit, free),
        (_by_name_alone, free),
    ):
        taken = {meaning.column for meaning in meant.values()}
        left = {header: cells for header, cells in strange.items() if header not in meant}
        meant |= guess(left, [column for column in columns if column not in taken], fits)
    return tuple(meant.get(header, Meaning(header, None)) for header in strange)


def _by_name(strange: Cells, free: Sequence[Column], fits: Fits) -> dict[str, Meaning]:
    """The headers that are like the name of a column that can hold their cells."""
    pairs = [
        (likeness(header, column), header, column)
        for header, cells in strange.items()
        for column in free
        if _may_hold(column, header)
        and _share(column, cells, fits) >= FITS
        and (column.key not in _DISTINCT or _differ(cells))
    ]
    meant: dict[str, Meaning] = {}
    taken: set[str] = set()
    for like, header, column in sorted(pairs, key=lambda pair: -pair[0]):
        if like > 0 and header not in meant and column.key not in taken:
            meant[header] = Meaning(header, column)
            taken.add(column.key)
    return meant


def _by_name_alone(strange: Cells, free: Sequence[Column], _: Fits) -> dict[str, Meaning]:
    """The headers that are like a name, whatever is under them: only a person knows."""
    named = _by_name(dict.fromkeys(strange, ()), free, lambda *_: True)
    return {header: replace(meaning, is_sure=False) for header, meaning in named.items()}


def _by_content(strange: Cells, free: Sequence[Column], fits: Fits) -> dict[str, Meaning]:
    """The headers whose cells are what a column holds."""
    meant: dict[str, Meaning] = {}
    for column in free:
        for header, cells in strange.items():
            is_it = any(cells) and _share(column, cells, fits) == 1 and _may_hold(column, header)
            if is_it and header not in meant and (column.key not in _DISTINCT or _differ(cells)):
                meant[header] = Meaning(header, column, is_sure=False)
                break
    return meant


def _by_unit(strange: Cells, free: Sequence[Column], fits: Fits) -> dict[str, Meaning]:
    """The headers with a unit that only one column can have."""
    meant: dict[str, Meaning] = {}
    left = list(free)
    for header, cells in strange.items():
        if split_header(header)[1] is None:
            continue
        can_be = [c for c in left if _may_hold(c, header) and _share(c, cells, fits) >= FITS]
        if len(can_be) == 1:
            meant[header] = Meaning(header, can_be[0], is_sure=False)
            left.remove(can_be[0])
    return meant


def _differ(cells: Sequence[str]) -> bool:
    return len(set(cells)) == len(cells)


def _may_hold(column: Column, header: str) -> bool:
    unit = split_header(header)[1]
    return unit is None or find_scale(column.dimension, unit) is not None


def _share(column: Column, cells: Sequence[str], fits: Fits) -> float:
    """The share of the cells that can belong to a column; 1 where all are empty."""
    filled = [cell for cell in cells if cell]
    return sum(fits(column, cell) for cell in filled) / len(filled) if filled else 1.0
