"""Crews in one cell, as people say them: `8H` is eight rowers, men."""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from warehouse.archive.sheets.cell_contents import FITS
from warehouse.archive.sheets.sheet import Sheet
from warehouse.archive.spelling.columns import Column, find_columns
from warehouse.archive.spelling.synonyms import CLASSES
from warehouse.archive.spelling.text import fold_word

CREW: Final = ("rowers", "crew_class")
"""Keys of the columns that one cell can hold together."""

_CREW: Final = re.compile(r"\s*([0-9]{1,2})\s*([^\W\d_]+)\s*")


def with_crews_apart(sheet: Sheet, wanted: Sequence[Column]) -> Sheet:
    """The table with rowers and class in a column each, where one column holds both.

    Where either column is missing, a column that is one of them, or that nobody knows, may hold
    crews. A number and letters are then apart in every cell, also where the letters are no class;
    another cell stays among the rowers. Where both are there, crews are taken apart whose class is
    left empty.

    Args:
        sheet: a table of a list.
        wanted: the columns of that list.
    """
    names = {c.key: c.header for c in wanted if c.key in CREW}
    if len(names) < len(CREW):
        return sheet
    optional = [replace(column, required=False) for column in wanted]
    places = find_columns(sheet.header, optional, sheet.line)
    if names.keys() <= places.keys():
        rowers, crew_class = (places[key].index for key in ("rowers", "crew_class"))
        rows = [replace(r, fields=_filled(r.fields, rowers, crew_class)) for r in sheet.rows]
        return replace(sheet, rows=rows)
    known = {column.index for key, column in places.items() if key not in names}
    place = next((k for k in range(len(sheet.header)) if k not in known and _crews(sheet, k)), None)
    if place is None:
        return sheet
    header = [*sheet.header, names["crew_class"]]
    header[place] = names["rowers"]
    return replace(
        sheet,
        header=header,
        rows=[replace(row, fields=_apart(row.fields, place, len(header))) for row in sheet.rows],
        crews=sheet.header[place].strip(),
    )


def _crews(sheet: Sheet, place: int) -> bool:
    """Whether a column holds crews."""
    cells = [row.fields[place] for row in sheet.rows if place < len(row.fields)]
    there = [cell for cell in cells if cell.strip()]
    return bool(there) and sum(_is_crew(cell) for cell in there) >= FITS * len(there)


def _is_crew(cell: str) -> bool:
    match = _CREW.fullmatch(cell)
    return match is not None and fold_word(match[2]) in CLASSES


def _filled(fields: Sequence[str], rowers: int, crew_class: int) -> list[str]:
    """A row with the class of a crew among the rowers in its own cell, empty or the same."""
    filled = list(fields)
    there = max(rowers, crew_class) < len(fields)
    match = _CREW.fullmatch(fields[rowers]) if there and _is_crew(fields[rowers]) else None
    said = fold_word(fields[crew_class]) if match else ""
    if match and (not said or CLASSES.get(said) == CLASSES[fold_word(match[2])]):
        filled[rowers], filled[crew_class] = match.groups()
    return filled


def _apart(fields: Sequence[str], place: int, width: int) -> list[str]:
    """A row with the class in the last column of so many."""
    apart = [*fields[: width - 1], *[""] * (width - 1 - len(fields))]
    match = _CREW.fullmatch(apart[place])
    apart[place], crew_class = match.groups() if match else (apart[place], "")
    return [*apart, crew_class, *fields[width - 1 :]]
